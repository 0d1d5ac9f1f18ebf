"""Assertions about attributes of a target."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.generation.literals import python_literal, python_string
from jausml_generators.bridge.checks.check import close_to, equals, holds
from jausml_generators.bridge.translation.expressions import BOOLEAN, INTEGER

if TYPE_CHECKING:
    from jausml_generators.bridge.checks.filling import Place, Scalar

SINGLE = 1e-6
"""More than the relative error of single precision."""


def has_value(place: Place, value: Scalar, tolerance: float = 0.0) -> list[str]:
    """Returns the assertions that an attribute is there and has a value.

    Args:
        tolerance: Largest difference of a number; 0 means what single precision may lose.
    """
    lines = is_there(place)
    if isinstance(value, str):
        return [*lines, equals(place.code, python_string(value))]
    if place.kind == BOOLEAN:
        return [*lines, holds(place.code if value else f"not {place.code}")]
    if place.kind == INTEGER and float(value).is_integer() and tolerance < 0.5:
        return [*lines, equals(place.code, str(int(value)))]
    if place.kind == INTEGER:
        return [*lines, close_to(place.code, float(value), max(tolerance, 0.501))]
    if math.isinf(value):
        return [*lines, equals(place.code, python_literal(float(value)))]
    return [*lines, close_to(place.code, float(value), tolerance)]


def is_absent(place: Place) -> list[str]:
    """Returns the assertion that an optional attribute is left out."""
    return [holds(f"{place.code} is None")]


def is_there(place: Place) -> list[str]:
    """Returns the assertions that an attribute is there."""
    return [holds(each) for each in place.conditions]
