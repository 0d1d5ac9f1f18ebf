"""Values as JSON has them, and commands both ways."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing import commands
from jausml.authoring.studio.typed import TypedError, typed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.editing.commands import Command

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


def command(value: Mapping[str, object], where: str = "command") -> Command:
    """Returns the command that an object of JSON means.

    Its `kind` names the command, so the class of a new element is its `type`.
    """
    given = dict(value)
    name = given.pop("kind", None)
    kind = _COMMANDS.get(name) if isinstance(name, str) else None
    if kind is None:
        raise TypedError(f"{where}.kind is one of {', '.join(_COMMANDS)}")
    if "type" in given:
        given["kind"] = given.pop("type")
    return typed(kind, given, where)


def as_json(value: Any) -> Any:
    """Returns what JSON can hold of a value.

    Dataclasses become objects, paths posix text, and numbers that JSON does not have null.
    """
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, str | int | float | bool | None):
        return value.value if isinstance(value, Enum) else value
    if is_dataclass(value):
        return _object(value)
    if isinstance(value, dict):
        return {str(name): as_json(each) for name, each in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [as_json(each) for each in value]
    if isinstance(value, Enum):
        return as_json(value.value)
    if isinstance(value, PurePath):
        return value.as_posix()
    raise TypeError(f"{type(value).__name__} has no place in JSON")


def _object(value: Any) -> dict[str, Any]:
    # A name of Python's own has an underscore behind it.
    found = {each.name.rstrip("_"): as_json(getattr(value, each.name)) for each in fields(value)}
    name = _NAMES.get(type(value))
    if name is None:
        return found
    if "kind" in found:
        found["type"] = found.pop("kind")
    return {"kind": name, **found}
