"""Legal values of numbers (SAE AS5684, value_set)."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.wire.errors import LayoutError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.wire.numbers import RealType

Ranges = tuple[tuple[int, int], ...]
"""Smallest and largest integer of each range, in order and apart."""


@dataclass(frozen=True)
class Listed:
    """A single legal integer with a meaning.

    Attributes:
        name: Its meaning.
        value: The integer.
        documentation: Text of the model.
    """

    name: str
    value: int
    documentation: str = ""


@dataclass(frozen=True)
class Interval:
    """A range of legal values as the definition states it.

    Attributes:
        lower: Lower limit.
        upper: Upper limit.
        has_lower: Whether the lower limit is legal.
        has_upper: Whether the upper limit is legal.
    """

    lower: float
    upper: float
    has_lower: bool = True
    has_upper: bool = True

    @property
    def first(self) -> float:
        """Smallest legal integer; a limit that is not finite remains."""
        if not math.isfinite(self.lower):
            return self.lower
        return math.ceil(self.lower) if self.has_lower else math.floor(self.lower) + 1

    @property
    def last(self) -> float:
        """Largest legal integer; a limit that is not finite remains."""
        if not math.isfinite(self.upper):
            return self.upper
        return math.floor(self.upper) if self.has_upper else math.ceil(self.upper) - 1


@dataclass(frozen=True)
class LegalIntegers:
    """The legal values of an integer or a group of bits.

    Attributes:
        ranges: All of them.
        listed: Those that have a meaning, in the order of the definition.
        intervals: The ranges that the definition states.
        offset: What is subtracted from a value to give the integer on the wire, which is 0 unless
            the definition counts from its lower limit (AS5684, offset_to_lower_limit).
    """

    ranges: Ranges
    listed: tuple[Listed, ...] = ()
    intervals: tuple[Interval, ...] = ()
    offset: int = 0

    @property
    def is_stated(self) -> bool:
        """Whether the definition says more than the type does."""
        return bool(self.listed or self.intervals)

    @property
    def is_closed(self) -> bool:
        """Whether every legal integer has a meaning."""
        return bool(self.listed) and not self.intervals

    @property
    def names(self) -> dict[int, str]:
        """Meanings by integer; of several meanings of one integer the first."""
        return {each.value: each.name for each in reversed(self.listed)}


@dataclass(frozen=True)
class LegalReals:
    """The legal values of a real number.

    Attributes:
        lower: Smallest of them.
        upper: Largest of them.
        intervals: The ranges that the definition states.
    """

    lower: float
    upper: float
    intervals: tuple[Interval, ...] = ()


def intervals_of(value_set: jaus.ValueSet | None) -> tuple[Interval, ...]:
    """Returns the ranges of a value set.

    Args:
        value_set: The value set, None for a field without one.
    """
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
    """Returns the single integers of a value set.

    Args:
        value_set: The value set, None for a field without one.
    """
    values = value_set.values if value_set is not None else ()
    return tuple(
        Listed(str(value.name), int(value.value), str(value.documentation or ""))
        for value in values
        if isinstance(value, jaus.EnumeratedValue)
    )


def legal_integers(value_set: jaus.ValueSet | None, lower: int, upper: int) -> LegalIntegers:
    """Returns the legal values of an integer.

    A value set of which nothing fits the type says nothing.

    Args:
        value_set: The value set, None for a field without one.
        lower: Smallest integer that the type can say.
        upper: Largest integer that the type can say.

    Raises:
        LayoutError: Its lower limit is no integer to count from.
    """
    listed, intervals = listed_in(value_set), intervals_of(value_set)
    offset = offset_of(value_set)
    lower, upper = lower + offset, upper + offset
    pairs: list[tuple[float, float]] = [(each.value, each.value) for each in listed]
    pairs += [(each.first, each.last) for each in intervals if each.lower <= each.upper]
    ranges = merged((int(max(first, lower)), int(min(last, upper))) for first, last in pairs)
    return LegalIntegers(ranges or ((lower, upper),), listed, intervals, offset)


def offset_of(value_set: jaus.ValueSet | None) -> int:
    """Returns what a value set subtracts from a value to give the integer on the wire.

    Args:
        value_set: The value set, None for a field without one.

    Raises:
        LayoutError: Its lower limit is no integer to count from.
    """
    if value_set is None or not value_set.offsetToLowerLimit:
        return 0
    limits = [each.value for each in listed_in(value_set)]
    lowest = min([*limits, *(each.lower for each in intervals_of(value_set))], default=0)
    if not float(lowest).is_integer():
        raise LayoutError(f"values cannot count from the lower limit {lowest}")
    return int(lowest)


def merged(ranges: Iterable[tuple[int, int]]) -> Ranges:
    """Returns as few ranges as hold the same integers.

    Args:
        ranges: Smallest and largest integer of each; one with none in it is left out.
    """
    found: list[tuple[int, int]] = []
    for first, last in sorted(ranges):
        if first > last:
            continue
        if found and first <= found[-1][1] + 1:
            found[-1] = (found[-1][0], max(last, found[-1][1]))
        else:
            found.append((first, last))
    return tuple(found)


def legal_reals(value_set: jaus.ValueSet | None, kind: RealType) -> LegalReals:
    """Returns the legal values of a real number.

    A set with single reals has no use; of several ranges the outer limits are kept.

    Args:
        value_set: The value set, None for a field without one.
        kind: The wire type, whose precision counts.

    Raises:
        LayoutError: It counts from its lower limit, which integers do.
    """
    if value_set is not None and value_set.offsetToLowerLimit:
        raise LayoutError(f"values of {kind.name} do not count from a lower limit")
    intervals = intervals_of(value_set)
    if value_set is None or not intervals or len(intervals) < len(value_set.values):
        return LegalReals(-kind.largest, kind.largest)
    lower = min(_end(kind, each.lower, legal=each.has_lower, up=True) for each in intervals)
    upper = max(_end(kind, each.upper, legal=each.has_upper, up=False) for each in intervals)
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
