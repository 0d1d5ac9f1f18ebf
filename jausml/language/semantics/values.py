"""Constants of assignments: whether a text is a value of an attribute."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from jausml.language.semantics.attributes import BOOL, NUMBER, TEXT, TIME, TIME_STAMP, Attribute

if TYPE_CHECKING:
    from collections.abc import Mapping

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
