"""ROS messages as lines of text, whatever their type."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

MOST_ELEMENTS = 8
"""Elements of an array that are shown."""

LONGEST_VALUE = 200
"""Characters of a text that are shown."""


def message_lines(message: Any, indent: str = "") -> Iterator[str]:
    """Yields the fields of a message, one a line, those of its parts below it."""
    for name in message.get_fields_and_field_types():
        value = getattr(message, name)
        if _is_message(value):
            yield f"{indent}{name}:"
            yield from message_lines(value, indent + "  ")
        elif _is_array(value):
            yield from _array_lines(name, value, indent)
        else:
            yield f"{indent}{name}: {_shown(value)}"


def _array_lines(name: str, values: Any, indent: str) -> Iterator[str]:
    first = [values[index] for index in range(min(len(values), MOST_ELEMENTS))]
    more = f", … ({len(values)} in all)" if len(values) > len(first) else ""
    if not first or not _is_message(first[0]):
        yield f"{indent}{name}: [{', '.join(map(_shown, first))}{more}]"
        return
    for index, each in enumerate(first):
        yield f"{indent}{name}[{index}]:"
        yield from message_lines(each, indent + "  ")
    if more:
        yield f"{indent}{name}: {more.removeprefix(', ')}"


def _is_message(value: Any) -> bool:
    return hasattr(value, "get_fields_and_field_types")


def _is_array(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, (str, bytes))


def _shown(value: Any) -> str:
    text = str(value) if isinstance(value, (bool, int, float, str)) else repr(value)
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 1] + "…"
