"""Functions of expressions, beyond `+ - *` and the comparisons of Python.

An operation without a value, such as a division by zero, raises `ConversionError`: the bridge drops
and counts the message, and its thread goes on.
"""

from __future__ import annotations

import math

from .types import ConversionError


def divide(dividend: float, divisor: float) -> float:
    """The quotient."""
    if divisor == 0:
        raise ConversionError(f"{dividend} divided by zero")
    return dividend / divisor


def power(base: float, exponent: float) -> float:
    """The power, if it is a real number."""
    try:
        return math.pow(base, exponent)
    except (ValueError, OverflowError):
        raise _no_value("power", base, exponent) from None


def modulo(dividend: float, divisor: float) -> float:
    """The remainder of a division, with the sign of the dividend."""
    try:
        return math.fmod(dividend, divisor)
    except ValueError:
        raise _no_value("fmod", dividend, divisor) from None


def remainder(dividend: float, divisor: float) -> float:
    """The remainder to the nearest multiple of the divisor, at most half of it."""
    try:
        return math.remainder(dividend, divisor)
    except ValueError:
        raise _no_value("remainder", dividend, divisor) from None


def root(value: float) -> float:
    """The square root."""
    if value < 0:
        raise _no_value("sqrt", value)
    return math.sqrt(value)


def sine(angle: float) -> float:
    """The sine of an angle in radians."""
    if math.isinf(angle):
        raise _no_value("sin", angle)
    return math.sin(angle)


def cosine(angle: float) -> float:
    """The cosine of an angle in radians."""
    if math.isinf(angle):
        raise _no_value("cos", angle)
    return math.cos(angle)


def tangent(angle: float) -> float:
    """The tangent of an angle in radians."""
    if math.isinf(angle):
        raise _no_value("tan", angle)
    return math.tan(angle)


def arc_sine(value: float) -> float:
    """The angle in [-pi/2, pi/2] of a sine."""
    if abs(value) > 1:
        raise _no_value("asin", value)
    return math.asin(value)


def arc_cosine(value: float) -> float:
    """The angle in [0, pi] of a cosine."""
    if abs(value) > 1:
        raise _no_value("acos", value)
    return math.acos(value)


def arc_tangent(value: float) -> float:
    """The angle in [-pi/2, pi/2] of a tangent."""
    return math.atan(value)


def direction(y: float, x: float) -> float:
    """The angle of a vector, in [-pi, pi]."""
    return math.atan2(y, x)


def length(x: float, y: float) -> float:
    """The length of a vector."""
    return math.hypot(x, y)


def magnitude(value: float) -> float:
    """The value without its sign."""
    return abs(value)


def least(*values: float) -> float:
    """The least of several values; NaN if one of them is NaN."""
    return math.nan if any(map(math.isnan, values)) else float(min(values))


def greatest(*values: float) -> float:
    """The greatest of several values; NaN if one of them is NaN."""
    return math.nan if any(map(math.isnan, values)) else float(max(values))


def round_down(value: float) -> float:
    """The next whole number below; infinity and NaN stay."""
    return float(math.floor(value)) if math.isfinite(value) else value


def round_up(value: float) -> float:
    """The next whole number above; infinity and NaN stay."""
    return float(math.ceil(value)) if math.isfinite(value) else value


def round_off(value: float) -> float:
    """The nearest whole number, the even one of two; infinity and NaN stay."""
    return float(round(value)) if math.isfinite(value) else value


def sign(value: float) -> float:
    """1 or -1 with the sign of the value; 0 and NaN stay."""
    return value if value == 0 or math.isnan(value) else math.copysign(1.0, value)


def is_finite(value: float) -> bool:
    """Returns whether a value is a number and not infinite."""
    return math.isfinite(value)


def _no_value(function: str, *values: float) -> ConversionError:
    return ConversionError(f"{function} has no value for {', '.join(map(str, values))}")
