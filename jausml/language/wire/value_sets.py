"""Value sets of the metamodel, as the legal values of numbers on the wire (SAE AS5684)."""

from __future__ import annotations

import math
import struct

from jausml.language.metamodel.classes import jaus
from jausml.language.wire.numbers import (
    Interval,
    LayoutError,
    LegalIntegers,
    LegalReals,
    Listed,
    RealType,
    merged,
)


def intervals_of(value_set: jaus.ValueSet | None) -> tuple[Interval, ...]:
    """Returns the ranges of a value set."""
    values = value_set.values if value_set is not None else ()
    return tuple(
        Interval(
            float(value.lower),
            float(value.upper),
            has_lower=bool(value.lowerInclusive),
            has_upper=bool(value.upperInclusive),
        )
        for value in values
        if isinstance(value, jaus.ValueRange)
    )


def listed_in(value_set: jaus.ValueSet | None) -> tuple[Listed, ...]:
    """Returns the single integers of a value set."""
    values = value_set.values if value_set is not None else ()
    return tuple(
        Listed(str(value.name), int(value.value), str(value.documentation or ""))
        for value in values
        if isinstance(value, jaus.EnumeratedValue)
    )


def legal_integers(value_set: jaus.ValueSet | None, lower: int, upper: int) -> LegalIntegers:
    """Returns the legal values of an integer.

    A value set of which nothing fits the type says nothing.
    """
    listed, intervals = listed_in(value_set), intervals_of(value_set)
    offset = offset_of(value_set)
    lower, upper = lower + offset, upper + offset
    pairs: list[tuple[float, float]] = [(value.value, value.value) for value in listed]
    pairs += [
        (interval.first, interval.last)
        for interval in intervals
        if interval.lower <= interval.upper
    ]
    ranges = merged((int(max(first, lower)), int(min(last, upper))) for first, last in pairs)
    return LegalIntegers(ranges or ((lower, upper),), listed, intervals, offset)


def offset_of(value_set: jaus.ValueSet | None) -> int:
    """Returns the number that is subtracted from a value to give the integer on the wire.

    Raises:
        LayoutError: Its lower limit is no integer to count from.
    """
    if value_set is None or not value_set.offsetToLowerLimit:
        return 0
    limits = [listed_value.value for listed_value in listed_in(value_set)]
    lowest = min([*limits, *(interval.lower for interval in intervals_of(value_set))], default=0)
    if not float(lowest).is_integer():
        raise LayoutError(f"values cannot count from the lower limit {lowest}")
    return int(lowest)


def legal_reals(value_set: jaus.ValueSet | None, kind: RealType) -> LegalReals:
    """Returns the legal values of a real number.

    A set with single reals has no use; of several ranges the outer limits are kept.

    Args:
        kind: The wire type, whose precision counts.

    Raises:
        LayoutError: It counts from its lower limit, which integers do.
    """
    if value_set is not None and value_set.offsetToLowerLimit:
        raise LayoutError(f"values of {kind.name} do not count from a lower limit")
    intervals = intervals_of(value_set)
    if value_set is None or not intervals or len(intervals) < len(value_set.values):
        return LegalReals(-kind.largest, kind.largest)
    lower = min(
        _end(kind, interval.lower, legal=interval.has_lower, up=True) for interval in intervals
    )
    upper = max(
        _end(kind, interval.upper, legal=interval.has_upper, up=False) for interval in intervals
    )
    return LegalReals(max(lower, -kind.largest), min(upper, kind.largest), intervals)


def _end(kind: RealType, limit: float, *, legal: bool, up: bool) -> float:
    """Returns the last legal number at a limit, `up` when legal numbers lie above it."""
    if kind.name == "float64" or abs(limit) > kind.largest:
        return limit if legal else math.nextafter(limit, math.inf if up else -math.inf)
    single: float = struct.unpack("<f", struct.pack("<f", limit))[0]
    # A limit that is not a single is met by the single next to it.
    if legal:
        return min(single, limit) if up else max(single, limit)
    beyond = single > limit if up else single < limit
    return single if beyond else _next_single(single, up=up)


def _next_single(value: float, *, up: bool) -> float:
    """Returns the single precision number above or below another."""
    if value == 0.0:
        return 2.0**-149 if up else -(2.0**-149)
    bits: int = struct.unpack("<I", struct.pack("<f", value))[0]
    step = 1 if up == (value > 0) else -1
    following: float = struct.unpack("<f", struct.pack("<I", bits + step))[0]
    return following
