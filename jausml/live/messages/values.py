"""Values of fields: names and units as messages show them, and what may stand in a field."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from numbers import Integral, Real
from typing import Any

from jausml.language import wire
from jausml.live.messages.errors import EncodeError, did_you_mean, similar

_SHOWN = re.compile(r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s+(\S.*)")
_NAMED = re.compile(r"(-?\d{1,20}) \((.*)\)")  # no integer of a message has more digits

_SYMBOLS = {
    "ampere": "A",
    "coulomb": "C",
    "cubic meter": "m3",
    "degree": "deg",
    "degree Celsius": "°C",
    "hertz": "Hz",
    "hour": "h",
    "kilogram": "kg",
    "liter": "l",
    "meter": "m",
    "meter per second": "m/s",
    "meter per second squared": "m/s2",
    "minute": "min",
    "newton": "N",
    "newton meter": "N m",
    "one": "",
    "percent": "%",
    "radian": "rad",
    "radian per second": "rad/s",
    "radian per second squared": "rad/s2",
    "second": "s",
    "volt": "V",
}
"""Symbols of the units of the library; others are shown as they are written."""


def symbol(unit: str) -> str:
    """Returns how a unit is shown; empty for numbers without one."""
    return _SYMBOLS.get(unit, unit)


def with_unit(text: str, unit: str) -> str:
    """Returns a number with its unit."""
    shown = symbol(unit)
    return f"{text} {shown}" if shown else text


def number_of(value: Any, unit: str = "") -> Any:
    """Returns the number of a text such as `1.25 m/s`; any other value as it is."""
    match = _SHOWN.fullmatch(value) if unit and isinstance(value, str) else None
    if match is None or match[2] not in (unit, symbol(unit)):
        return value
    try:
        return int(match[1])  # which a float of more than 53 bits would change
    except ValueError:
        return float(match[1])


class NamedValue(str):
    """An integer that a definition names: the name as text and in JSON, `int(value)` the number.

    It is equal to both. As a key, and in sets, it is its name.
    """

    __slots__ = ("_number",)

    _number: int

    def __new__(cls, name: str, number: int) -> NamedValue:
        """Makes a value."""
        instance = super().__new__(cls, name)
        instance._number = number
        return instance

    def __getnewargs__(self) -> tuple[str, int]:  # type: ignore[override]
        return str(self), self._number

    def __eq__(self, other: object) -> bool:
        if isinstance(other, NamedValue):
            return self._number == other._number and str.__eq__(self, other)
        return str.__eq__(self, other) if isinstance(other, str) else self._number == other

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = str.__hash__

    def __bool__(self) -> bool:
        return bool(self._number)

    def __int__(self) -> int:
        return self._number

    __index__ = __int__


def named_values(names: Mapping[int, str]) -> dict[int, NamedValue]:
    """Returns the values of integers; a name that several have is none, as it does not tell."""
    count = Counter(names.values())
    return {number: NamedValue(name, number) for number, name in names.items() if count[name] == 1}


def as_numbers(value: Any) -> Any:
    """Returns fields with the numbers of their named values."""
    match value:
        case NamedValue():
            return int(value)
        case dict():
            return {name: as_numbers(member) for name, member in value.items()}
        case list() | tuple():
            return [as_numbers(item) for item in value]
        case _:
            return value


MOST_SHOWN = 8
"""Values and ranges that an error message names."""

LONGEST_SHOWN = 60
"""Characters of a value in an error message."""

_NO_NAMES: Mapping[int, str] = {}

# -- checks ----------------------------------------------------------------------------------------


def as_number(value: Any) -> int | float:
    """Returns a value that is a number, such as those of numpy are."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    if isinstance(value, Real) and not isinstance(value, bool):
        return int(value) if isinstance(value, Integral) else float(value)
    raise EncodeError(f"{shown(value)} is not a number")


def as_object(value: Any) -> dict[str, Any]:
    """Returns a value that is an object."""
    if isinstance(value, dict):
        return value
    raise EncodeError(f"{shown(value)} is not an object of fields")


def as_list(value: Any) -> list[Any]:
    """Returns a value that is a list."""
    if isinstance(value, (list, tuple)):
        return list(value)
    raise EncodeError(f"{shown(value)} is not a list")


def latin1(value: Any) -> bytes:
    """Returns a text as bytes, one for each character."""
    if not isinstance(value, str):
        raise EncodeError(f"{shown(value)} is not a string")
    try:
        return value.encode("latin-1")
    except UnicodeEncodeError:
        raise EncodeError(f"{shown(value)} has characters beyond Latin-1") from None


def legal_integer(
    value: Any, ranges: wire.Ranges, names: Mapping[int, str] = _NO_NAMES, unit: str = ""
) -> int:
    """Returns the legal integer that a value or the name of one means.

    Args:
        value: The value; a real without a fraction counts as an integer, as in JSON, and so does
            a text as the integer is shown, with its name, such as `1 (READY)`, or its unit.
    """
    if isinstance(value, NamedValue) and value not in names.values():
        value = int(value)
    match = _NAMED.fullmatch(value) if isinstance(value, str) else None
    if match and names.get(int(match[1])) == match[2]:
        value = int(match[1])
    value = number_of(value, unit)
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


def _named(name: str, ranges: wire.Ranges, names: Mapping[int, str]) -> int:
    values = [value for value, meaning in names.items() if meaning == name]
    if len(values) > 1:
        raise EncodeError(f"{shown(name)} is the name of {', '.join(map(str, values))}: give one")
    if values:
        return values[0]
    hint = did_you_mean([repr(suggestion) for suggestion in similar(name, names.values())])
    hint = hint or f"; they are {integers_in_words(ranges, names)}"
    raise EncodeError(f"{shown(name)} is no name of a legal value{hint}")


def no_words(_name: str) -> str:
    """Returns an empty text, for fields whose legal values are clear."""
    return ""


def check_names(
    fields: Mapping[str, Any],
    known: Collection[str],
    needed: Iterable[str],
    legal: Callable[[str], str] = no_words,
) -> None:
    """Refuses an object with unknown or without needed fields; the error names all of them."""
    errors = []
    meant: set[str] = set()
    for name in fields:
        if name not in known:
            error, suggested = _unknown(str(name), fields, known)
            errors.append(error)
            meant.update(suggested)
    for name in needed:
        if name not in fields and name not in meant:
            words = legal(name)
            reason = f"this field is absent{f', it takes {words}' * bool(words)}"
            errors.append(EncodeError(reason, name))
    if errors:
        raise errors[0].beside(errors[1:])


def _unknown(
    name: str, fields: Mapping[str, Any], known: Collection[str]
) -> tuple[EncodeError, list[str]]:
    """Returns the error of an unknown name, and the absent names that may be meant."""
    absent = [field for field in known if field not in fields]
    suggested = similar(name, absent)
    hint = did_you_mean(suggested or similar(name, known))
    if not hint and absent:
        hint = f"; it may be {listed(absent)}"
    return EncodeError(f"unknown field{hint}", name), suggested


# -- words -----------------------------------------------------------------------------------------


def shown(value: Any) -> str:
    """Returns a value for an error message, cut when it is long."""
    if isinstance(value, (dict, list, tuple)):
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, int) and value.bit_length() > 4 * LONGEST_SHOWN:
        return f"an integer of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


def listed(words: Sequence[str], most: int | None = MOST_SHOWN) -> str:
    """Returns words with commas between them, and dots for those beyond a limit."""
    return ", ".join(words[:most]) + (", ..." if most is not None and len(words) > most else "")


def integers_in_words(
    ranges: wire.Ranges, names: Mapping[int, str] = _NO_NAMES, most: int | None = MOST_SHOWN
) -> str:
    """Returns legal integers, e.g. `0 (Set current command), 1 .. 3`."""
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


def formats_in_words(kind: wire.FormattedOctets) -> str:
    """Returns the formats of bytes with their names."""
    ranges = tuple((name, name) for name in sorted(kind.names))
    return integers_in_words(ranges, kind.names)


def options_in_words(kind: wire.Variant) -> str:
    """Returns the options of a variant with their tags."""
    names = (f"{tag} {option.name}" for tag, option in enumerate(kind.options))
    return "the options are " + (", ".join(names) or "none: write 0")


def in_words(kind: wire.Kind) -> str:  # noqa: C901 - a branch for each kind
    """Returns the values that a field may have in words, for an error message."""
    match kind:
        case wire.Integer():
            return in_units(integers_in_words(kind.legal.ranges, kind.legal.names), kind.units)
        case wire.Real():
            return in_units(f"{kind.legal.lower!r} .. {kind.legal.upper!r}", kind.units)
        case wire.Scaled():
            return in_units(f"{kind.lower!r} .. {kind.upper!r}", kind.units)
        case wire.BitField():
            return f"an object of {listed([group.name for group in kind.groups])}"
        case wire.FixedText():
            return f"text of at most {kind.length} characters"
        case wire.Text():
            return f"text of {kind.count.lower} .. {kind.count.upper} characters"
        case wire.Octets():
            shape = "an object of message or hex" if kind.holds_message else "an object of hex"
            what = f" of {kind.content}" if kind.content else ""
            return f"{shape}, {kind.count.lower} .. {kind.count.upper} bytes{what}"
        case wire.FormattedOctets():
            return f"an object of format and hex; format is {formats_in_words(kind)}"
        case wire.VariableNumber():
            types = (f"{index} ({in_words(number)})" for index, number in kind.by_index.items())
            return f"an object of index and value; index is {', '.join(types)}"
        case wire.Record():
            names = [member.name for member in kind.members]
            return f"an object of {listed(names)}" if names else "an empty object"
        case wire.List():
            return f"a list of {kind.count.lower} .. {kind.count.upper} elements"
        case wire.Array():
            return f"a list of {kind.length} elements"
        case wire.Variant():
            return f"an object of one option, {options_in_words(kind)}"


def in_units(text: str, units: str) -> str:
    """Returns a number with its units as definitions write them."""
    return f"{text} {units}" if units and units != "one" else text
