"""Attributes at the end of paths: what a path leads to, its values, and those compared by name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import takewhile
from typing import TypeAlias

from jausml.language.interfaces.definitions import INTEGER_RANGES, TEXTS
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.semantics.names import words
from jausml.language.wire import REALS

JausPart: TypeAlias = "jaus.Field | jaus.SubField | jaus.Alternative | jaus.Format"
Part: TypeAlias = "JausPart | ros.Field"

NUMBER = "number"
NUMBERS = "numbers"
BOOL = "bool"
TEXT = "text"
OCTETS = "octets"
LIST = "list"
TIME_STAMP = "TimeStamp"
TIME = "builtin_interfaces/Time"

COUNT = "count"
"""The step behind a list or an array that leads to the number of its elements."""

EMPTY = frozenset({TEXT, OCTETS, LIST, NUMBERS})
"""Kinds of what may be empty."""

LARGEST_SINGLE = REALS["float32"].largest
UNSTATED = "unstated"


@dataclass(frozen=True, slots=True)
class Attribute:
    """The end of a path: the attribute that it leads to.

    Attributes:
        kind: `number`, `numbers`, `bool`, `text`, `octets`, `list`, `TimeStamp`, the full name of a
            ROS type (`geometry_msgs/Quaternion`), or empty for what no assignment can fill or read.
        length: Largest number of bytes or characters of a text, None for no limit.
        optional: Whether it is a JAUS field that a message may leave out.
        step: Distance between neighbouring numbers: 1 for integers, the least significant bit of
            scaled JAUS fields; None for floating point.
        units: Unit of its numbers as the model writes it, empty when none is known.
        count: Number of elements of a fixed array, None for others.
        may_lack: Whether a message may have no value there: a JAUS field on the way is left out, or
            another option was chosen; a marker says so in ROS, or a sequence is too short.
        says_unknown: Whether it can say that it has no value: an optional JAUS field is left out, a
            text or a sequence empty, a marker says so in ROS.
    """

    kind: str
    name: str
    integral: bool = False
    lower: float | None = None
    upper: float | None = None
    values: tuple[tuple[float, float], ...] = ()
    length: int | None = None
    encoding: str = "utf-8"
    optional: bool = False
    named: bool = False
    step: float | None = None
    is_single: bool = False
    units: str = ""
    frame: str = UNSTATED
    label: str = ""
    constants: tuple[tuple[str, str], ...] = ()
    carries: bool = False
    count: int | None = None
    is_ros: bool = False
    field: Part | None = None
    may_lack: bool = False
    says_unknown: bool = False


@dataclass(frozen=True, slots=True)
class PathFault:
    """Why a path leads nowhere."""

    message: str
    hint: str = ""


Found = Attribute | PathFault | None
"""None: what the path leads through was not read, so nothing can be said."""


def count_of_elements(label: str) -> Attribute:
    """Returns the attribute that is the number of elements of a list."""
    name = f"the number of elements of '{label}'"
    return Attribute(NUMBER, name, integral=True, lower=0, upper=2**32 - 1, step=1, label=COUNT)


def nearest_name(name: str, fields: Iterable[Part]) -> str:
    """Returns a hint for a name that is not among those of some fields."""
    known = [field.name for field in fields if field.name]
    near = [
        candidate for candidate in known if candidate.lower() == name.lower()
    ] or get_close_matches(name, known, n=1)
    if near:
        return f"did you mean '{near[0]}'?"
    return f"it has {', '.join(known)}" if 0 < len(known) <= 8 else ""


def primitive(kind: str) -> Attribute:
    """Returns the attribute of a value of a ROS primitive type."""
    if kind == "bool":
        return Attribute(BOOL, "a bool")
    if kind in TEXTS:
        return Attribute(TEXT, "text")
    if kind in INTEGER_RANGES:
        lower, upper = INTEGER_RANGES[kind]
        return Attribute(NUMBER, "a number", integral=True, lower=lower, upper=upper, step=1)
    if kind == "float32":
        limit = LARGEST_SINGLE
        return Attribute(NUMBER, "a number", lower=-limit, upper=limit, is_single=True)
    if kind == "float64":
        return Attribute(NUMBER, "a number")
    return Attribute("", f"a {kind}")


_INTEGER = re.compile(r"[+-]?(?:0|[1-9][0-9]{0,24})")
NOT_FINITE = frozenset({"NaN", "Infinity", "-Infinity"})
_REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def constant_fault(text: str, attribute: Attribute, names: Mapping[str, str] | None = None) -> str:
    """Says why a text is no value of an attribute, or returns an empty string."""
    if attribute.kind == NUMBER:
        names = dict(attribute.constants) if names is None else names
        named = names.get(text.strip(), text)
        return _number_fault(named.strip(), attribute)
    if attribute.kind == BOOL:
        return "" if text in ("true", "false") else "is not true or false"
    if attribute.kind == TEXT:
        return _text_fault(text, attribute)
    if attribute.kind in (TIME, TIME_STAMP):
        return f"cannot be {attribute.name}; a ClockAssignment gives the present time"
    return f"cannot be {attribute.name}"


def octets_of(text: str) -> bytes | None:
    """Returns the octets that pairs of hexadecimal digits stand for; None for another text."""
    try:
        return bytes.fromhex(text)
    except ValueError:
        return None


def is_integer(text: str) -> bool:
    """Tells whether a text is an integer in decimal digits, without leading zeros."""
    return _INTEGER.fullmatch(text) is not None


def is_real(text: str) -> bool:
    """Tells whether a text is a finite decimal number, with an exponent or without."""
    return _REAL.fullmatch(text) is not None and math.isfinite(float(text))


def _number_fault(text: str, attribute: Attribute) -> str:
    if attribute.integral and not is_integer(text):
        return "is not an integer"
    # Floats of ROS can hold these; numbers of JAUS fields have a range.
    if text in NOT_FINITE and attribute.is_ros and not attribute.integral:
        return ""
    if not is_real(text):
        return "is not a number"
    value = int(text) if attribute.integral else float(text)
    if attribute.lower is not None and value < attribute.lower:
        return f"is below {attribute.lower:g}, the smallest value"
    if attribute.upper is not None and value > attribute.upper:
        return f"is above {attribute.upper:g}, the largest value"
    if attribute.values and not any(low <= value <= high for low, high in attribute.values):
        return "is not in the value set of the field"
    return ""


def _text_fault(text: str, attribute: Attribute) -> str:
    try:
        encoded = text.encode(attribute.encoding)
    except UnicodeEncodeError:
        return "has characters that JAUS text (latin-1) cannot hold"
    size = len(encoded) if attribute.encoding == "latin-1" else len(text)
    if attribute.length is not None and size > attribute.length:
        return f"is longer than {attribute.length} characters"
    return ""


_LEAST_COMMON = 2  # names that both sides have from which on they are taken for one enumeration


@dataclass(frozen=True)
class NamedValue:
    """A value that has a name."""

    name: str
    number: int


_TRUE, _FALSE = NamedValue("true", 1), NamedValue("false", 0)

_Named: TypeAlias = "tuple[list[str], NamedValue]"
"""A value with the words of its name."""


@dataclass(frozen=True)
class Comparison:
    """Two enumerations."""

    source: dict[str, NamedValue]
    target: dict[str, NamedValue]

    @property
    def common(self) -> list[tuple[NamedValue, NamedValue]]:
        """The values that both have by name, in the order of the source."""
        return [
            (value, self.target[key]) for key, value in self.source.items() if key in self.target
        ]

    @property
    def renumbered(self) -> list[tuple[NamedValue, NamedValue]]:
        """The values that both have by name, with other numbers."""
        return [(one, other) for one, other in self.common if one.number != other.number]

    @property
    def unmatched(self) -> list[NamedValue]:
        """The values of the source of which the target has neither the name nor the number."""
        numbers = {value.number for value in self.target.values()}
        return [
            value
            for key, value in self.source.items()
            if key not in self.target and value.number not in numbers
        ]

    @property
    def is_of_one_enumeration(self) -> bool:
        """Whether so many names are common that both sides mean the same values."""
        # An enumeration of one value cannot have two in common with another.
        return len(self.common) >= min(_LEAST_COMMON, len(self.source), len(self.target))


def compared(source: Attribute, target: Attribute) -> Comparison | None:
    """Returns the enumerations of the ends of an assignment; None if not both have names.

    A flag has those names of the other end that mean true and false to it without a doubt.
    """
    comparison = Comparison(
        _of_flag(source, target) or named_values(source),
        _of_flag(target, source) or named_values(target),
    )
    return comparison if comparison.source and comparison.target and comparison.common else None


_SWITCHED = {
    "on": "off",
    "true": "false",
    "yes": "no",
    "active": "inactive",
    "enabled": "disabled",
    "enable": "disable",
}
"""Names of two values, of which a flag without a name of its own says the first."""
_OPENED = (("open", "closed"), ("opened", "closed"), ("open", "close"))
"""Names of two values, of which a flag says the one that it is called like."""
_PLAIN = frozenset({"data", "value", "state", "status"})
"""Words in the name of a flag that say nothing of what it is."""


def _of_flag(flag: Attribute, other: Attribute) -> dict[str, NamedValue]:
    """Returns true and false by their names at the other end; nothing where there is a doubt.

    The last word of the flag's name tells, or it says no more than the name of the other end.
    """
    values = named_values(other) if flag.kind == BOOL else {}
    flag_words = _words(flag.label)
    # A "not" in the name turns the meaning of its last word.
    if not values or not flag_words or "not" in flag_words:
        return {}
    is_plain, last = {*flag_words} <= {*_PLAIN, *_words(other.label)}, flag_words[-1]
    for pair in (*_SWITCHED.items(), *_OPENED):
        if {*pair} <= values.keys():
            is_switched = pair not in _OPENED
            if last == pair[0] or (is_switched and (is_plain or last in _SWITCHED)):
                return {pair[0]: _TRUE, pair[1]: _FALSE}
            if last == pair[1] or (is_switched and last in _SWITCHED.values()):
                return {pair[0]: _FALSE, pair[1]: _TRUE}
    return {}


def named_values(attribute: Attribute) -> dict[str, NamedValue]:
    """Returns the named values of a number, by their names without case, separators and prefix.

    Constants of a ROS type belong to all of its fields. Those that begin with the name of the field
    are its own, else those that begin with the first words of that name; where none does, all
    count. What all names have in common at their beginning is no part of them.
    """
    if attribute.kind != NUMBER or not attribute.integral:
        return {}
    constants = [
        (_words(name), NamedValue(name, int(float(value))))
        for name, value in attribute.constants
        if is_real(value)
    ]
    if attribute.is_ros:
        constants = _own(_words(attribute.label), constants)
    constants = [(phrase, value) for phrase, value in constants if phrase]
    common = _common([phrase for phrase, _ in constants])
    return {"".join(phrase[common:]): value for phrase, value in constants}


def _own(label: list[str], constants: list[_Named]) -> list[_Named]:
    """Returns the constants of a field: those with the longest beginning of its name."""
    for length in range(len(label), 0, -1):
        beginning = "".join(label[:length])
        own = [
            (rest, value)
            for phrase, value in constants
            if (rest := _without(beginning, phrase)) is not None
        ]
        if own:
            return own
    return constants


def _without(beginning: str, name: list[str]) -> list[str] | None:
    """Returns the words of a name behind a beginning; None where it begins otherwise."""
    for length in range(1, len(name) + 1):
        if "".join(name[:length]) == beginning:
            return name[length:]
    return None


def _common(names: list[list[str]]) -> int:
    """Returns how many words several names have in common at their beginning, none a whole name."""
    if len(names) < _LEAST_COMMON:
        return 0
    # The last word always stays: without it a name would be empty.
    columns = zip(*(name[:-1] for name in names), strict=False)
    return sum(1 for _ in takewhile(lambda column: len({*column}) == 1, columns))


def table_text(comparison: Comparison, *, to_ros: bool) -> str:
    """Returns the entries of a table that maps common values by their names, as text."""
    entries = table_entries(comparison, to_ros=to_ros)
    return "  ".join(f"{_written(jaus.name)} <-> {_written(ros.name)}" for jaus, ros in entries)


def table_entries(comparison: Comparison, *, to_ros: bool) -> list[tuple[NamedValue, NamedValue]]:
    """Returns the entries of a table that maps common values by their names: of JAUS, and of ROS.

    They are in the order of the JAUS values, so that both directions have one table.
    """
    pairs = comparison.common if to_ros else [(other, one) for one, other in comparison.common]
    return sorted(pairs, key=lambda pair: pair[0].number)


def _written(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z_]\w*", name) else f'"{name}"'


def _words(name: str) -> list[str]:
    return [word.casefold() for word in words(name)]
