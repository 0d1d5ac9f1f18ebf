"""Fields by paths, written as messages are shown: `ElementList[0].ElementUID=3`."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from jausml.language import wire
from jausml.live.messages.errors import EncodeError

_ABSENT = object()
_PATH = r"\w+(?:\[\d+\])*(?:\.\w+(?:\[\d+\])*)*"
_STEP = re.compile(r"(\w+)|\[(\d+)\]")
_ASSIGNMENT = re.compile(rf"(?:^|(?<=\s))({_PATH})=")


def completed(record: wire.Record, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns fields in the shapes of `MessageEntry.decode`.

    Args:
        record: The body; its one member need not be named.
        fields: Their names may be paths, or their ends, where one path alone has them.

    Raises:
        EncodeError: Two fields contradict each other, or elements before one are not there.
    """
    members = record.members
    is_whole = len(members) != 1 or any(_first(path) == members[0].name for path in fields)
    kind = record if is_whole else members[0].kind
    nested_fields = by_name(_from_ends(kind, fields))
    return nested_fields if is_whole else {members[0].name: nested_fields}


def _first(path: str) -> str:
    return re.split(r"[.\[]", path, maxsplit=1)[0]


def _from_ends(kind: wire.Kind, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns fields by whole paths, where a path left out its beginning and is unique."""
    places: dict[str, list[str]] = {}
    for name, path in _named_inside(kind, ""):
        places.setdefault(name, []).append(path)
    direct = {member.name for member in kind.members} if isinstance(kind, wire.Record) else set()
    fields_by_path: dict[str, Any] = {}
    for path, value in fields.items():
        first = _first(str(path))
        prefixes = [] if first in direct else places.get(first, [])
        _add(fields_by_path, f"{prefixes[0]}{path}" if len(prefixes) == 1 else path, value)
    return fields_by_path


def _named_inside(kind: wire.Kind, before: str) -> Iterator[tuple[str, str]]:
    """Yields the names in records and bit fields, with the paths before them."""
    if isinstance(kind, wire.BitField):
        yield from ((group.name, before) for group in kind.groups)
    if isinstance(kind, wire.Record):
        for member in kind.members:
            yield member.name, before
            yield from _named_inside(member.kind, f"{before}{member.name}.")


def by_name(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns fields in which names that are paths have become objects and lists.

    Objects of one place are joined, in whatever order they stand; none of them is changed.

    Raises:
        EncodeError: Two fields contradict each other, or elements before one are not there.
    """
    nested_fields: dict[str, Any] = {}
    try:
        for path, value in fields.items():
            steps: list[str | int] = [path]
            if re.fullmatch(_PATH, str(path)):
                steps = [name or int(index) for name, index in _STEP.findall(str(path))]
            nested_fields = _joined(nested_fields, steps, value, str(path))
    except RecursionError:
        raise EncodeError("the fields are nested too deep") from None
    return nested_fields


def _joined(before: Any, steps: Sequence[str | int], value: Any, path: str) -> Any:
    """Returns what stands at a place (`_ABSENT`: nothing yet) with a value where steps lead."""
    if not steps:
        if before is _ABSENT:
            return value
        if not (isinstance(before, dict) and isinstance(value, dict)):
            raise EncodeError("this contradicts another field", path)
        for name, member in value.items():
            before = _joined(before, [name], member, path)
        return before
    step, *following = steps
    if before is _ABSENT:
        before = [] if isinstance(step, int) else {}
    if isinstance(step, int) and isinstance(before, list):
        if step > len(before):
            raise EncodeError(f"element {len(before)} is not given before", path)
        inner = before[step] if step < len(before) else _ABSENT
        return [*before[:step], _joined(inner, following, value, path), *before[step + 1 :]]
    if isinstance(step, str) and isinstance(before, dict):
        return {**before, step: _joined(before.get(step, _ABSENT), following, value, path)}
    raise EncodeError("this contradicts another field", path)


class JsonError(ValueError):
    """Why a text is no JSON, or what of it has no one meaning."""


def parse_json(text: str) -> Any:
    """Returns a value of JSON (`JsonError`: it is none, or an object has a name twice)."""
    try:
        return _read(text)
    except json.JSONDecodeError as error:
        raise JsonError(f"column {error.colno}: {error.msg}") from error


def _read(text: str) -> Any:
    try:
        return json.loads(text, object_pairs_hook=_object)
    except (json.JSONDecodeError, JsonError):
        raise
    except ValueError:
        raise JsonError("an integer has too many digits") from None
    except RecursionError:
        raise JsonError("nested too deep") from None


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(members) < len(pairs):
        ((name, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise JsonError(f"{name!r} stands twice in an object")
    return members


def parse_fields(text: str) -> dict[str, Any]:
    """Returns fields from an object of JSON, or from `PATH=VALUE PATH=VALUE`, as they are shown.

    A value behind a path is JSON, or text up to the next path.

    Raises:
        ValueError: It is neither.
    """
    matches = list(_ASSIGNMENT.finditer(text))
    try:
        if matches and not text[: matches[0].start()].strip():
            return _assigned(text, matches)
        fields = parse_json(text)
    except JsonError as error:
        raise ValueError(f"the fields are no JSON: {error}") from error
    if not isinstance(fields, dict):
        raise ValueError('the fields must be a JSON object, e.g. {"AuthorityCode": 5}')
    return fields


def _assigned(text: str, matches: list[re.Match[str]]) -> dict[str, Any]:
    ends = [*(match.start() for match in matches[1:]), len(text)]
    fields: dict[str, Any] = {}
    for match, end in zip(matches, ends, strict=True):
        _add(fields, match[1], _value(text[match.end() : end].strip()))
    return fields


def _add(fields: dict[str, Any], path: str, value: Any) -> None:
    if path in fields:
        raise EncodeError("this is there twice", path)
    fields[path] = value


def _value(text: str) -> Any:
    try:
        return _read(text)
    except json.JSONDecodeError:
        return text[1:-1] if text[:1] == text[-1:] == "'" and len(text) > 1 else text
