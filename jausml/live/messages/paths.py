"""Fields by paths, as messages are shown: `ElementList[0].ElementUID=3`."""

from __future__ import annotations

import json
import re
from typing import Any

from jausml.live.messages.errors import EncodeError

_PATH = r"\w+(?:\[\d+\])*(?:\.\w+(?:\[\d+\])*)*"
_STEP = re.compile(r"(\w+)|\[(\d+)\]")
_ASSIGNMENT = re.compile(rf"(?:^|(?<=\s))({_PATH})=")


def by_name(fields: dict[str, Any]) -> dict[str, Any]:
    """Returns fields in which names that are paths have become objects and lists."""
    made: dict[str, Any] = {}
    for path, value in fields.items():
        steps = [name or int(index) for name, index in _STEP.findall(str(path))]
        if len(steps) < 2 or not re.fullmatch(_PATH, str(path)):
            made[path] = value
            continue
        _put(made, steps, value, str(path))
    return made


def _put(holder: Any, steps: list[str | int], value: Any, path: str) -> None:
    """Puts a value where steps lead, and makes what is on the way."""
    for step, following in zip(steps, [*steps[1:], None], strict=True):
        inner = value if following is None else ([] if isinstance(following, int) else {})
        if isinstance(step, int) and isinstance(holder, list):
            if step > len(holder):
                raise EncodeError(f"element {len(holder)} is not given before", path)
            if step == len(holder):
                holder.append(inner)
        elif isinstance(step, str) and isinstance(holder, dict):
            holder.setdefault(step, inner)
        else:
            raise EncodeError("this contradicts another field", path)
        if following is None:
            holder[step] = value
        holder = holder[step]


def parse_fields(text: str) -> dict[str, Any]:
    """Returns fields from an object of JSON, or from `PATH=VALUE PATH=VALUE`, as they are shown.

    A value behind a path is JSON, or text up to the next path.

    Raises:
        ValueError: It is neither.
    """
    found = list(_ASSIGNMENT.finditer(text))
    if found and not text[: found[0].start()].strip():
        return _assigned(text, found)
    try:
        fields = json.loads(text)
    except json.JSONDecodeError as error:
        raise ValueError(f"the fields are no JSON: {error}") from error
    if not isinstance(fields, dict):
        raise ValueError('the fields must be a JSON object, e.g. {"AuthorityCode": 5}')
    return fields


def _assigned(text: str, found: list[re.Match[str]]) -> dict[str, Any]:
    ends = [*(each.start() for each in found[1:]), len(text)]
    return {
        each[1]: _value(text[each.end() : end].strip())
        for each, end in zip(found, ends, strict=True)
    }


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text[1:-1] if text[:1] == text[-1:] == "'" and len(text) > 1 else text
