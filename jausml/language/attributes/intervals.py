"""Interval arithmetic: where values lie after an operation when those of its operands are known.

An interval is a pair of its ends, which may be infinite; `EMPTY` has no values at all, which is the
result of operations that never have one, such as the square root of -4 .. -1. Intervals are never
narrower than the truth: what computes in double precision, as bridges do, gives values within.
Sums, products and quotients are rounded there as here, and rounding keeps the order, so that their
ends are exact; of the other functions the last bits are not known, and their ends are widened.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

Interval = tuple[float, float]

EMPTY: Interval = (math.inf, -math.inf)
EVERYTHING: Interval = (-math.inf, math.inf)
FALSE: Interval = (0.0, 0.0)
TRUE: Interval = (1.0, 1.0)
EITHER: Interval = (0.0, 1.0)
# More than the last bits that a mathematical library may miss.
_ROUNDING = 2.0**-48
# Beyond this the turns of an angle are not told apart reliably.
_MANY_TURNS = 1e6


def is_empty(interval: Interval) -> bool:
    """Whether no value lies within."""
    return interval[0] > interval[1]


def hull(*intervals: Interval) -> Interval:
    """The smallest interval around others."""
    return min(low for low, _ in intervals), max(high for _, high in intervals)


def meet(left: Interval, right: Interval) -> Interval:
    """Returns the part that two intervals share."""
    both = max(left[0], right[0]), min(left[1], right[1])
    return EMPTY if is_empty(both) else both


def negated(a: Interval) -> Interval:
    """The opposite sign."""
    return -a[1], -a[0]


def total(a: Interval, b: Interval) -> Interval:
    """Sum."""
    return _low(a[0] + b[0]), _high(a[1] + b[1])


def difference(a: Interval, b: Interval) -> Interval:
    """Difference."""
    return total(a, negated(b))


def product(a: Interval, b: Interval) -> Interval:
    """Product."""
    return _around((0.0 if x == 0.0 or y == 0.0 else x * y) for x in a for y in b)


def quotient(a: Interval, b: Interval) -> Interval:
    """Quotient, where the divisor is not 0."""
    if b == (0.0, 0.0):
        return EMPTY
    if b[0] < 0.0 < b[1]:
        return EVERYTHING
    return _around(_quotient(x, y, 1.0 if b[1] > 0.0 else -1.0) for x in a for y in b)


def power(a: Interval, b: Interval) -> Interval:
    """Power, where it is a real number."""
    if b[0] == b[1] and float(b[0]).is_integer():
        return _whole_power(a, b[0])
    if a[1] < 0.0 and b[0] == b[1]:
        return EMPTY
    positive = _real_power((max(a[0], 0.0), max(a[1], 0.0)), b) if a[1] >= 0.0 else EMPTY
    if a[0] >= 0.0 or b[0] == b[1]:
        return positive
    # Some exponent is an integer: then a negative base has a power of either sign.
    largest = _real_power(absolute(a), b)[1]
    return -largest, largest


def absolute(a: Interval) -> Interval:
    """Magnitude."""
    if a[0] >= 0.0:
        return a
    return negated(a) if a[1] <= 0.0 else (0.0, max(-a[0], a[1]))


def least(*operands: Interval) -> Interval:
    """The least of several values."""
    return min(low for low, _ in operands), min(high for _, high in operands)


def greatest(*operands: Interval) -> Interval:
    """The greatest of several values."""
    return max(low for low, _ in operands), max(high for _, high in operands)


def increasing(
    function: Callable[[float], float], domain: Interval = EVERYTHING, *, exact: bool = False
) -> Callable[[Interval], Interval]:
    """Returns the function that gives the interval of a function that increases in its domain."""

    def bound(a: Interval) -> Interval:
        within = meet(a, domain)
        if is_empty(within):
            return EMPTY
        ends = function(within[0]), function(within[1])
        return ends if exact else _widened(*ends)

    return bound


def arc_cosine(a: Interval) -> Interval:
    """Arc cosine, which decreases."""
    within = meet(a, (-1.0, 1.0))
    return EMPTY if is_empty(within) else _widened(math.acos(within[1]), math.acos(within[0]))


def sine(a: Interval) -> Interval:
    """Sine."""
    if not _few_turns(a):
        return -1.0, 1.0
    low, high = _widened(*sorted((math.sin(a[0]), math.sin(a[1]))))
    if _has_angle(a, -math.pi / 2):
        low = -1.0
    if _has_angle(a, math.pi / 2):
        high = 1.0
    return max(low, -1.0), min(high, 1.0)


def cosine(a: Interval) -> Interval:
    """Cosine."""
    if not _few_turns(a):
        return -1.0, 1.0
    low, high = _widened(*sorted((math.cos(a[0]), math.cos(a[1]))))
    if _has_angle(a, math.pi):
        low = -1.0
    if _has_angle(a, 0.0):
        high = 1.0
    return max(low, -1.0), min(high, 1.0)


def tangent(a: Interval) -> Interval:
    """Tangent."""
    if not _few_turns(a) or _has_angle(a, math.pi / 2) or _has_angle(a, -math.pi / 2):
        return EVERYTHING
    return _widened(math.tan(a[0]), math.tan(a[1]))


def direction(y: Interval, x: Interval) -> Interval:
    """The angle of a vector (atan2)."""
    if y[0] <= 0.0 <= y[1] and x[0] <= 0.0:
        return _widened(-math.pi, math.pi)
    return _widened(*_around(math.atan2(b, a) for b in y for a in x))


def length(x: Interval, y: Interval) -> Interval:
    """The length of a vector (hypot)."""
    x, y = absolute(x), absolute(y)
    low, high = _widened(math.hypot(x[0], y[0]), math.hypot(x[1], y[1]))
    return max(low, 0.0), high


def modulo(a: Interval, b: Interval) -> Interval:
    """Returns the remainders of a division, with the sign of the dividend (fmod)."""
    largest = absolute(b)[1]
    if largest == 0.0:
        return EMPTY
    return max(min(a[0], 0.0), -largest), min(max(a[1], 0.0), largest)


def remainder(a: Interval, b: Interval) -> Interval:
    """Returns the remainders by the nearest whole number, at most half of the divisor."""
    (_, farthest), (least, largest) = absolute(a), absolute(b)
    if largest == 0.0:
        return EMPTY
    if farthest < least / 2:
        return a
    bound = min(farthest, largest / 2)
    return -bound, bound


def less(a: Interval, b: Interval) -> Interval:
    """Whether a < b."""
    return _verdict(always=a[1] < b[0], never=a[0] >= b[1])


def at_most(a: Interval, b: Interval) -> Interval:
    """Whether a <= b."""
    return _verdict(always=a[1] <= b[0], never=a[0] > b[1])


def equal(a: Interval, b: Interval) -> Interval:
    """Whether a == b."""
    return _verdict(always=a[0] == a[1] == b[0] == b[1], never=is_empty(meet(a, b)))


def truth(a: Interval) -> Interval:
    """Whether a value counts as true, that is, differs from 0."""
    return inverse(equal(a, FALSE))


def inverse(a: Interval) -> Interval:
    """The opposite of a truth."""
    return 1.0 - a[1], 1.0 - a[0]


def _verdict(*, always: bool, never: bool) -> Interval:
    if always:
        return TRUE
    return FALSE if never else EITHER


def _whole_power(a: Interval, exponent: float) -> Interval:
    if exponent == 0.0:
        return 1.0, 1.0
    if exponent < 0.0 and a == (0.0, 0.0):
        return EMPTY
    low, high = _real_power(absolute(a), (exponent, exponent))
    if exponent % 2 == 0:
        return low, high
    if exponent < 0.0:
        if a[0] < 0.0 < a[1]:
            return EVERYTHING
        return (low, high) if a[1] > 0.0 else (-high, -low)
    return _widened(*(math.copysign(_power(abs(end), exponent), end) for end in a))


def _real_power(a: Interval, b: Interval) -> Interval:
    low, high = _widened(*_around(_power(x, y) for x in a for y in b))
    return max(low, 0.0), high


def _power(base: float, exponent: float) -> float:
    """The power of a base that is not negative, in the limit where it has none."""
    if base == 0.0 and exponent < 0.0:
        return math.inf
    try:
        return math.pow(base, exponent)
    except OverflowError:
        return math.inf


def _quotient(x: float, y: float, sign: float) -> float:
    """The quotient in the limit; a divisor of 0 is approached from the side of a sign."""
    if y == 0.0:
        return 0.0 if x == 0.0 else math.copysign(math.inf, x * sign)
    if math.isinf(x) and math.isinf(y):
        return math.copysign(math.inf, x * sign)
    return x / y


def _around(values: Iterable[float]) -> Interval:
    numbers = list(values)
    return min(numbers), max(numbers)


def _low(value: float) -> float:
    return -math.inf if math.isnan(value) else value


def _high(value: float) -> float:
    return math.inf if math.isnan(value) else value


def _widened(low: float, high: float) -> Interval:
    below = math.nextafter(low - abs(low) * _ROUNDING, -math.inf) if math.isfinite(low) else low
    above = math.nextafter(high + abs(high) * _ROUNDING, math.inf) if math.isfinite(high) else high
    return below, above


def _few_turns(a: Interval) -> bool:
    return max(abs(a[0]), abs(a[1])) < _MANY_TURNS


def _has_angle(a: Interval, angle: float) -> bool:
    """Whether an interval may have an angle, by whole turns."""
    turns = math.ceil((a[0] - angle) / math.tau - 1e-9)
    return angle + turns * math.tau <= a[1] + 1e-8
