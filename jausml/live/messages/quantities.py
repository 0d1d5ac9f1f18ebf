"""Numbers with their units, as messages are shown: `1.25 m/s`."""

from __future__ import annotations

import re
from typing import Any

_SHOWN = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s+(\S.*)")
_NAMED = re.compile(r"([+-]?\d+) \(.*\)")

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
    """Returns the number of a text such as `1.25 m/s` or `1 (READY)`; any other value as it is.

    Args:
        unit: The unit that the number must have, in words or as a symbol.
    """
    if not isinstance(value, str):
        return value
    if (named := _NAMED.fullmatch(value)) is not None:
        return int(named[1])
    found = _SHOWN.fullmatch(value)
    if found is None or not unit or found[2] not in (unit, symbol(unit)):
        return value
    return float(found[1])
