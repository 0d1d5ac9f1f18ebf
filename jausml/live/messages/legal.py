"""Legal integers: in words, and of a value or the name of one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.live.messages.codec import as_number, shown
from jausml.live.messages.errors import EncodeError, did_you_mean, similar

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Ranges = tuple[tuple[int, int], ...]
"""Smallest and largest legal integer of each range."""

MOST_SHOWN = 8
"""Values and ranges that an error message names."""

_NO_NAMES: Mapping[int, str] = {}


def legal_integer(value: Any, ranges: Ranges, names: Mapping[int, str] = _NO_NAMES) -> int:
    """Returns the legal integer that a value or the name of one means.

    Args:
        value: The value; a real without a fraction counts as an integer, as in JSON.
        ranges: The legal integers.
        names: Names of some of them, which may stand instead.

    Raises:
        EncodeError: It is none.
    """
    if isinstance(value, str) and names:
        return _named(value, ranges, names)
    number = as_number(value)
    if isinstance(number, float):
        if not number.is_integer():
            raise EncodeError(f"{shown(value)} is not an integer")
        number = int(number)
    for lower, upper in ranges:
        if lower <= number <= upper:
            return number
    legal = integers_in_words(ranges, names)
    raise EncodeError(f"{shown(number)} is not among the legal values {legal}")


def _named(name: str, ranges: Ranges, names: Mapping[int, str]) -> int:
    found = [value for value, each in names.items() if each == name]
    if len(found) > 1:
        raise EncodeError(f"{shown(name)} is the name of {', '.join(map(str, found))}: give one")
    if found:
        return found[0]
    hint = did_you_mean([repr(each) for each in similar(name, names.values())])
    hint = hint or f"; they are {integers_in_words(ranges, names)}"
    raise EncodeError(f"{shown(name)} is no name of a legal value{hint}")


def integers_in_words(
    ranges: Ranges, names: Mapping[int, str] = _NO_NAMES, most: int | None = MOST_SHOWN
) -> str:
    """Returns legal integers, e.g. `0 (Set current command), 1 .. 3`.

    Args:
        ranges: The legal integers.
        names: Names of some of them.
        most: How many values and ranges to name; None names all.
    """
    parts: list[str] = []
    for lower, upper in ranges:
        named = sorted(value for value in names if lower <= value <= upper)
        words = [f"{value} ({names[value]})" for value in named]
        if len(named) == upper - lower + 1:
            parts += words
            continue
        span = str(lower) if lower == upper else f"{lower} .. {upper}"
        parts.append(f"{span} with {listed(words, most)}" if words else span)
    return listed(parts, most)


def listed(words: Sequence[str], most: int | None = MOST_SHOWN) -> str:
    """Returns words with commas between them.

    Args:
        words: The words.
        most: How many to take; what is left out leaves dots. None takes all.
    """
    return ", ".join(words[:most]) + (", ..." if most is not None and len(words) > most else "")
