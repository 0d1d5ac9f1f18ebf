"""Values as JSON has them, both ways: what is of another type is refused, not converted."""

from __future__ import annotations

import collections.abc
import math
import types
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import lru_cache, partial
from inspect import Parameter, signature
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from jausml.authoring.editing import commands

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.editing.project import Project
    from jausml.authoring.editing.records import Entry, Freshness


MadeT = TypeVar("MadeT")

_WORDS = {str: "a text", int: "a whole number", float: "a number", bool: "true or false"}

_COMMANDS: Mapping[str, type[Command]] = {
    "set": commands.Set,
    "add": commands.Add,
    "remove": commands.Remove,
    "move": commands.Move,
    "rename": commands.Rename,
    "create": commands.Create,
    "place": commands.Place,
}

_NAMES = {kind: name for name, kind in _COMMANDS.items()}


class TypedError(Exception):
    """A value is not of its type; the message says which."""


def typed(call: Callable[..., MadeT], value: object, where: str = "params") -> Callable[[], MadeT]:
    """Returns a call, of a class or function, with the members of an object as its parameters."""
    try:
        made: Callable[[], MadeT] = _bound(call, value, where)
    except RecursionError as error:
        raise TypedError(f"{where} is too deep") from error
    return made


def _typed(kind: Any, value: Any, where: str) -> Any:
    origin = get_origin(kind)
    if kind is object:
        return value
    if is_dataclass(kind):
        return _bound(kind, value, where)()
    if origin in (Union, types.UnionType):
        return _one_of(get_args(kind), value, where)
    if origin is Literal:
        if value not in get_args(kind):
            raise TypedError(f"{where} is one of {', '.join(map(str, get_args(kind)))}")
        return value
    if origin is tuple:
        return _list(get_args(kind), value, where)
    if origin in (dict, collections.abc.Mapping):
        return _mapping(get_args(kind)[1], value, where)
    return _plain(kind, value, where)


def _bound(call: Any, value: Any, where: str) -> Any:
    """Returns what a dataclass or another callable makes of an object with its parameters."""
    if not isinstance(value, dict):
        raise TypedError(f"{where} is an object")
    hints, known = _hints(getattr(call, "func", call)), signature(call).parameters
    unknown = [each for each in value if each not in known]
    if unknown:
        raise TypedError(f"{where} has no {unknown[0]!a}")
    for name, each in known.items():
        if each.default is Parameter.empty and name not in value:
            raise TypedError(f"{where} lacks {name}")
    return partial(
        call,
        **{name: _typed(hints[name], each, f"{where}.{name}") for name, each in value.items()},
    )


@lru_cache(maxsize=256)
def _hints(kind: Any) -> Mapping[str, Any]:
    return get_type_hints(kind)


def _one_of(kinds: tuple[Any, ...], value: Any, where: str) -> Any:
    if value is None and type(None) in kinds:
        return None
    others = [each for each in kinds if each is not type(None)]
    faults = []
    for each in others:
        try:
            return _typed(each, value, where)
        except TypedError as fault:
            faults.append(fault)
    raise faults[0]


def _list(kinds: tuple[Any, ...], value: Any, where: str) -> Any:
    if not isinstance(value, list):
        raise TypedError(f"{where} is a list")
    if kinds[-1] is Ellipsis:
        kinds = kinds[:1] * len(value)
    if len(value) != len(kinds):
        raise TypedError(f"{where} has {len(kinds)} values")
    pairs = enumerate(zip(kinds, value, strict=True))
    return tuple(_typed(kind, each, f"{where}[{index}]") for index, (kind, each) in pairs)


def _mapping(kind: Any, value: Any, where: str) -> Any:
    if not isinstance(value, dict):
        raise TypedError(f"{where} is an object")
    return {
        _plain(str, name, f"a name in {where}"): _typed(kind, each, f"{where}[{name!a}]")
        for name, each in value.items()
    }


def _plain(kind: Any, value: Any, where: str) -> Any:
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = _float(value, where)
    if type(value) is not kind:
        raise TypedError(f"{where} is {_WORDS[kind]}")
    if kind is float and not math.isfinite(value):
        raise TypedError(f"{where} is a finite number")
    if kind is str and not _is_unicode(value):
        raise TypedError(f"{where} is no Unicode text")
    return value


def _float(value: int, where: str) -> float:
    try:
        return float(value)
    except OverflowError as error:
        raise TypedError(f"{where} is too large") from error


def _is_unicode(text: str) -> bool:
    """Tells whether a text has no half of a pair of surrogates, which no file can hold."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def command(value: Mapping[str, object], where: str = "command") -> Command:
    """Returns the command that an object of JSON means.

    Its `kind` names the command, so the class of a new element is its `type`.
    """
    given = dict(value)
    name = given.pop("kind", None)
    kind: Any = _COMMANDS.get(name) if isinstance(name, str) else None
    if kind is None:
        raise TypedError(f"{where}.kind is one of {', '.join(_COMMANDS)}")
    if "type" in given:
        given["kind"] = given.pop("type")
    made: Command = typed(kind, given, where)()
    return made


def as_json(value: Any) -> Any:
    """Returns what JSON can hold of a value.

    Dataclasses become objects, paths posix text, and numbers that JSON does not have null.
    """
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, str | int | float | bool | None):
        return value.value if isinstance(value, Enum) else value
    if is_dataclass(value):
        return _members(value)
    if isinstance(value, dict):
        return {str(name): as_json(each) for name, each in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [as_json(each) for each in value]
    if isinstance(value, Enum):
        return as_json(value.value)
    if isinstance(value, PurePath):
        return value.as_posix()
    raise TypeError(f"{type(value).__name__} has no place in JSON")


def _members(value: Any) -> dict[str, Any]:
    # A name of Python's own has an underscore behind it.
    found = {each.name.rstrip("_"): as_json(getattr(value, each.name)) for each in fields(value)}
    name = _NAMES.get(type(value))
    if name is None:
        return found
    if "kind" in found:
        found["type"] = found.pop("kind")
    return {"kind": name, **found}


def files_as_json(project: Project) -> list[dict[str, Any]]:
    """Returns the files of a project."""
    return [
        {
            "path": each.path,
            "notation": each.notation,
            "revision": each.revision,
            "stale": each.is_stale,
            "dirty": each.is_dirty,
        }
        for each in project.files
    ]


def freshness_as_json(found: Freshness) -> dict[str, Any]:
    """Returns what an answer is worth."""
    return {"state": found.state, "since": found.since, "why": found.why}


def entry_as_json(made: Entry | None) -> dict[str, Any] | None:
    """Returns an entry of the log; None for none."""
    if made is None:
        return None
    return {
        "number": made.number,
        "label": made.label,
        "files": made.files,
        "created": made.created,
        "layout": made.layout,
        "outside": made.is_outside,
    }
