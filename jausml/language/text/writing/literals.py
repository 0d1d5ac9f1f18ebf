"""Values of attributes as they stand in ros2jaus text."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, cast

from jausml.language.metamodel import FeatureTable, ValueKind
from jausml.language.text.tree import Href, Name, Number, Text

if TYPE_CHECKING:
    from jausml.language.metamodel import DataTypeTable

NO_VALUE = Href("")
"""Stands where a feature that has a default has no value, which XMI writes as `xsi:nil`."""

_NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?|0x[0-9A-Fa-f]+")
_ADDRESS = re.compile(r"[0-9]+\.[0-9]+\.[0-9]+")
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*")
_PROSE = frozenset({"documentation", "holdReason", "units"})


def is_number(text: str) -> bool:
    """Tells whether a text is a number as the language writes it."""
    return _NUMBER.fullmatch(text) is not None


def number(value: float) -> Number | Text:
    """Returns a real number without a needless fraction; as text where it is no number."""
    if not math.isfinite(value):
        return Text("NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity")
    return Number(repr(float(value)).removesuffix(".0"))


def constant(text: str) -> Name | Number | Text:
    """Returns a text that stands for a number, for true or false, or for itself."""
    if text in ("true", "false"):
        return Name(text)
    return Number(text) if is_number(text) else Text(text)


def word_or_constant(text: str) -> Name | Number | Text:
    """Returns a text without quotation marks where it is a number or a word."""
    return Name(text) if _WORD.fullmatch(text) else constant(text)


def attribute_value(value: Any, feature: FeatureTable) -> Name | Number | Text | Href:
    """Returns one value of an attribute."""
    if value is None:
        return NO_VALUE
    kind = cast("DataTypeTable", feature.data_type).kind
    if kind is ValueKind.ENUMERATION:
        return Name(str(value.literal or value.name) if hasattr(value, "name") else str(value))
    if kind is ValueKind.BOOLEAN:
        return Name("true" if value else "false")
    if kind is ValueKind.INTEGER:
        return Number(str(value))
    if kind is ValueKind.REAL:
        return number(value)
    if feature.name in _PROSE:
        return Text(value)
    return Number(value) if _ADDRESS.fullmatch(value) else word_or_constant(value)


def is_name(text: str | None) -> bool:
    """Tells whether a text can stand as a name, with or without back quotes.

    Names of several steps are names too (`geometry_msgs/Twist`, `Receiving.Ready`), but no step of
    them may be empty; a topic may begin with "/".
    """
    if not text or "`" in text or not text.isprintable() or text != text.strip():
        return False
    return all(re.split("[./]", text.removeprefix("/")))
