"""Functions of expressions, beyond `+ - *` and the comparisons of Python.

Where an operation has no value, such as a division by zero, it raises `ConversionError`, which
drops the message and is counted: no number of a peer ends the thread of a bridge.
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
    """The power, where it is a real number."""
    try:
        return math.pow(base, exponent)
    except (ValueError, OverflowError):
        raise _none("power", base, exponent) from None


def modulo(dividend: float, divisor: float) -> float:
    """What a division leaves, with the sign of the dividend."""
    try:
        return math.fmod(dividend, divisor)
    except ValueError:
        raise _none("fmod", dividend, divisor) from None


def remainder(dividend: float, divisor: float) -> float:
    """What a division by the nearest whole number leaves, at most half of the divisor."""
    try:
        return math.remainder(dividend, divisor)
    except ValueError:
        raise _none("remainder", dividend, divisor) from None


def root(value: float) -> float:
    """The square root."""
    if value < 0:
        raise _none("sqrt", value)
    return math.sqrt(value)


def sine(angle: float) -> float:
    """The sine of an angle in radians."""
    if math.isinf(angle):
        raise _none("sin", angle)
    return math.sin(angle)


def cosine(angle: float) -> float:
    """The cosine of an angle in radians."""
    if math.isinf(angle):
        raise _none("cos", angle)
    return math.cos(angle)


def tangent(angle: float) -> float:
    """The tangent of an angle in radians."""
    if math.isinf(angle):
        raise _none("tan", angle)
    return math.tan(angle)


def arc_sine(value: float) -> float:
    """The angle in [-pi/2, pi/2] of a sine."""
    if abs(value) > 1:
        raise _none("asin", value)
    return math.asin(value)


def arc_cosine(value: float) -> float:
    """The angle in [0, pi] of a cosine."""
    if abs(value) > 1:
        raise _none("acos", value)
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
    """The least of several values; not a number when one of them is none."""
    return math.nan if any(map(math.isnan, values)) else float(min(values))


def greatest(*values: float) -> float:
    """The greatest of several values; not a number when one of them is none."""
    return math.nan if any(map(math.isnan, values)) else float(max(values))


def round_down(value: float) -> float:
    """The next whole number below; what is not finite stays so."""
    return float(math.floor(value)) if math.isfinite(value) else value


def round_up(value: float) -> float:
    """The next whole number above; what is not finite stays so."""
    return float(math.ceil(value)) if math.isfinite(value) else value


def round_off(value: float) -> float:
    """The nearest whole number, the even one of two; what is not finite stays so."""
    return float(round(value)) if math.isfinite(value) else value


def sign(value: float) -> float:
    """1 or -1, as the sign says; 0 and what is not a number stay so."""
    return value if value == 0 or math.isnan(value) else math.copysign(1.0, value)


def is_finite(value: float) -> bool:
    """Whether a value is a number and not infinite."""
    return math.isfinite(value)


def _none(function: str, *values: float) -> ConversionError:
    return ConversionError(f"{function} has no value for {', '.join(map(str, values))}")
