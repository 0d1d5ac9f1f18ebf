"""Conversions of numbers."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from typing import TypeVar

from .types import ConversionError

_DEGREE = math.pi / 180.0
_RADIAN = 180.0 / math.pi

Key = TypeVar("Key", bound="Hashable")
Value = TypeVar("Value")


def negate(value: float) -> float:
    """The value with the opposite sign."""
    return -value


def scale(value: float, factor: float) -> float:
    """The value times `factor`."""
    return value * factor


def linear(value: float, factor: float, offset: float) -> float:
    """The value times `factor` plus `offset`."""
    return value * factor + offset


def clamp(value: float, minimum: float, maximum: float) -> float:
    """The value limited to minimum .. maximum; NaN stays."""
    if value < minimum:
        return minimum
    if value > maximum:
        return maximum
    return value


def limit(value: float, maximum: float) -> float:
    """The value limited to -`maximum` .. `maximum`; NaN stays."""
    return clamp(value, -maximum, maximum)


def deadband(value: float, width: float) -> float:
    """Zero when the magnitude is below `width`, else the value."""
    return 0.0 if abs(value) < width else value


def square(value: float) -> float:
    """The value squared."""
    return value * value


def degrees_to_radians(value: float) -> float:
    """Degrees to radians."""
    return value * _DEGREE


def radians_to_degrees(value: float) -> float:
    """Radians to degrees."""
    return value * _RADIAN


def square_root(value: float) -> float:
    """The square root: variance to root mean square; NaN for a negative value."""
    return math.sqrt(value) if value >= 0.0 else math.nan


def covariance_to_rms(x: float, y: float, z: float) -> float:
    """The variances along three axes to one root mean square for each of the axes.

    Three zeros, or a negative variance, give NaN: ROS marks unknown variances so (sensor_msgs/Imu).
    """
    if x == y == z == 0.0 or not (x >= 0.0 and y >= 0.0 and z >= 0.0):
        return math.nan
    return math.sqrt((x + y + z) / 3)


def value_to_percent(value: float, maximum: float) -> float:
    """The value in percent of `maximum`.

    Raises:
        ConversionError: The maximum is zero.
    """
    if maximum == 0.0:
        raise ConversionError("nothing is a percentage of zero")
    return value / maximum * 100.0


def percent_to_value(value: float, maximum: float) -> float:
    """Percent of `maximum` to the value."""
    return value / 100.0 * maximum


def look_up(value: Key, table: Mapping[Key, Value]) -> Value:
    """The value of a key in a table.

    Raises:
        ConversionError: The table lacks the key.
    """
    try:
        return table[value]
    except KeyError:
        raise ConversionError(f"{value!r} is not in the table") from None
