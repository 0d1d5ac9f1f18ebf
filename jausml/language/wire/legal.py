"""Legal values of numbers, resolved from value sets (SAE AS5684), and errors of definitions."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.wire.numbers import Interval, LegalIntegers, LegalReals, Listed

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.wire.numbers import Ranges, RealType


class LayoutError(ValueError):
    """A message definition that cannot be encoded; `jausml validate` tells more.

    Attributes:
        path: Names of the message and its fields down to the wrong one, joined by dots.
    """

    def __init__(self, reason: str, path: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.path = path

    def __str__(self) -> str:
        return f"{self.path}: {self.reason}" if self.path else self.reason

    def inside(self, step: str) -> LayoutError:
        """Puts a step before the path and returns the error, on its way out of a container."""
        self.path = f"{step}.{self.path}" if self.path else step
        return self


class LimitError(LayoutError):
    """A message definition that has a layout, but one beyond what machines should work on."""


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
    pairs: list[tuple[float, float]] = [(each.value, each.value) for each in listed]
    pairs += [(each.first, each.last) for each in intervals if each.lower <= each.upper]
    ranges = merged((int(max(first, lower)), int(min(last, upper))) for first, last in pairs)
    return LegalIntegers(ranges or ((lower, upper),), listed, intervals, offset)


def offset_of(value_set: jaus.ValueSet | None) -> int:
    """Returns what a value set subtracts from a value to give the integer on the wire.

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
