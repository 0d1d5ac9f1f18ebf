"""Attributes at the end of paths: what a path leads to, and which texts are values of it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import TypeAlias

    from jausml.language.metamodel.classes import jaus, ros

    JausPart: TypeAlias = jaus.Field | jaus.SubField | jaus.Alternative | jaus.Format
    Part: TypeAlias = JausPart | ros.Field


NUMBER = "number"
NUMBERS = "numbers"
BOOL = "bool"
TEXT = "text"
OCTETS = "octets"
LIST = "list"
TIME_STAMP = "TimeStamp"
TIME = "builtin_interfaces/Time"

LARGEST_SINGLE = 3.4028234663852886e38
UNSTATED = "unstated"

_INTEGER_ROS = {
    **{f"int{n}": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)},
    **{f"uint{n}": (0, 2**n - 1) for n in (8, 16, 32, 64)},
    "byte": (0, 255),
    "char": (0, 255),
}


@dataclass(frozen=True, slots=True)
class Attribute:
    """The end of a path: the attribute that it leads to.

    Attributes:
        kind: `number`, `numbers`, `bool`, `text`, `octets`, `list`, `TimeStamp`, the full name of a
            ROS type (`geometry_msgs/Quaternion`), or empty for what no assignment can fill or read.
        lower: Smallest legal number, None for no limit.
        upper: Largest legal number, None for no limit.
        length: Largest number of bytes or characters of a text, None for no limit.
        optional: Whether it is a JAUS field that a message may leave out.
        named: Whether the value set of a number gives single values a meaning.
        step: Distance between neighbouring numbers: 1 for integers, the least significant bit of
            scaled JAUS fields; None for floating point.
        units: Unit of its numbers as the model writes it, empty when none is known.
        count: Number of elements of a fixed array, None for others.
        field: The field or sub-field of the model, None where there is none.
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


@dataclass(frozen=True, slots=True)
class PathFault:
    """Why a path leads nowhere."""

    message: str
    hint: str = ""


Found = Attribute | PathFault | None
"""None: what the path leads through was not read, so nothing can be said."""


def nearest_name(name: str, fields: Iterable[Part]) -> str:
    """Returns a hint for a name that is not among those of some fields."""
    known = [field.name for field in fields if field.name]
    near = [k for k in known if k.lower() == name.lower()] or get_close_matches(name, known, n=1)
    if near:
        return f"did you mean '{near[0]}'?"
    return f"it has {', '.join(known)}" if 0 < len(known) <= 8 else ""


def primitive(kind: str) -> Attribute:
    """Returns what a value of a ROS primitive type is."""
    if kind == "bool":
        return Attribute(BOOL, "a bool")
    if kind in ("string", "wstring"):
        return Attribute(TEXT, "text")
    if kind in _INTEGER_ROS:
        lower, upper = _INTEGER_ROS[kind]
        return Attribute(NUMBER, "a number", integral=True, lower=lower, upper=upper, step=1)
    if kind == "float32":
        limit = LARGEST_SINGLE
        return Attribute(NUMBER, "a number", lower=-limit, upper=limit, is_single=True)
    if kind == "float64":
        return Attribute(NUMBER, "a number")
    return Attribute("", f"a {kind}")


_INTEGER = re.compile(r"[+-]?(?:0|[1-9][0-9]{0,24})")
_NOT_FINITE = frozenset({"NaN", "Infinity", "-Infinity"})
_REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def constant_fault(text: str, attribute: Attribute, names: Mapping[str, str] | None = None) -> str:
    """Says why a text is no value of an attribute, or returns an empty string.

    Args:
        names: The constants of the attribute, from who asks for many texts.
    """
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


def is_integer(text: str) -> bool:
    """Tells whether a text is an integer in decimal digits, without leading zeros."""
    return _INTEGER.fullmatch(text) is not None


def is_real(text: str) -> bool:
    """Tells whether a text is a finite decimal number, with an exponent or without."""
    return _REAL.fullmatch(text) is not None and math.isfinite(float(text))


def _number_fault(text: str, attribute: Attribute) -> str:
    if attribute.integral and not is_integer(text):
        return "is not an integer"
    if text in _NOT_FINITE and attribute.is_ros and not attribute.integral:
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
