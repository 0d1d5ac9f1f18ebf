"""Numbers on the wire, little endian: types, legal values and kinds of fields (SAE AS5684)."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias


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
    """A message definition with a layout beyond the limits of this toolchain."""


def merged(ranges: Iterable[tuple[int, int]]) -> Ranges:
    """Returns as few ranges as hold the same integers.

    Args:
        ranges: Smallest and largest integer of each; one with none in it is left out.
    """
    spans: list[tuple[int, int]] = []
    for first, last in sorted(ranges):
        if first > last:
            continue
        if spans and first <= spans[-1][1] + 1:
            spans[-1] = (spans[-1][0], max(last, spans[-1][1]))
        else:
            spans.append((first, last))
    return tuple(spans)


_SLACK = 1e-3  # part of a step by which floating point may miss an integer that was decoded before


@dataclass(frozen=True)
class IntegerType:
    """An integer type."""

    name: str
    format: str
    size: int
    lower: int
    upper: int

    @property
    def is_unsigned(self) -> bool:
        """Whether it can count."""
        return self.lower == 0

    @property
    def bits(self) -> int:
        """Number of bits."""
        return 8 * self.size


@dataclass(frozen=True)
class RealType:
    """A floating point type (IEEE 754)."""

    name: str
    format: str
    size: int
    largest: float


def _integer_type(name: str, letter: str) -> IntegerType:
    size = struct.calcsize(f"<{letter}")
    bits = 8 * size
    if letter.isupper():
        return IntegerType(name, letter, size, 0, (1 << bits) - 1)
    return IntegerType(name, letter, size, -(1 << bits - 1), (1 << bits - 1) - 1)


INTEGERS = {
    name: _integer_type(name, letter)
    for name, letter in {
        "uint8": "B",
        "int8": "b",
        "uint16": "H",
        "int16": "h",
        "uint32": "I",
        "int32": "i",
        "uint64": "Q",
        "int64": "q",
    }.items()
}
"""The integer types by their names."""

UNSIGNED = {
    name: integer_type for name, integer_type in INTEGERS.items() if integer_type.is_unsigned
}
"""The types of counts, tags, presence vectors, bit fields and scaled numbers."""

REALS = {
    "float32": RealType("float32", "f", 4, 3.4028234663852886e38),
    "float64": RealType("float64", "d", 8, 1.7976931348623157e308),
}
"""The floating point types by their names."""

Ranges = tuple[tuple[int, int], ...]
"""Smallest and largest integer of each range, in order and apart."""


@dataclass(frozen=True)
class Listed:
    """A single legal integer with a meaning."""

    name: str
    value: int
    documentation: str = ""


@dataclass(frozen=True)
class Interval:
    """A range of legal values as the definition states it."""

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
        listed: Those that have a meaning, in the order of the definition.
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
        return {listed_value.value: listed_value.name for listed_value in reversed(self.listed)}


@dataclass(frozen=True)
class LegalReals:
    """The legal values of a real number."""

    lower: float
    upper: float
    intervals: tuple[Interval, ...] = ()


@dataclass(frozen=True)
class Integer:
    """An integer (AS5684 fixed_field)."""

    type: IntegerType
    legal: LegalIntegers
    units: str = ""

    @property
    def reach(self) -> tuple[int, int]:
        """Smallest and largest value that the wire can bring, legal or not."""
        return self.type.lower + self.legal.offset, self.type.upper + self.legal.offset

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


@dataclass(frozen=True)
class Real:
    """A floating point number, finite (AS5684 fixed_field)."""

    type: RealType
    legal: LegalReals
    units: str = ""

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


@dataclass(frozen=True)
class Scaled:
    """An unsigned integer that stands for a real number (AS5684 scale_range).

    The value is `lower + integer * step`.

    Attributes:
        lower: Value of the integer 0.
        upper: Value of the largest integer.
        rounding: How a value between two integers is encoded: `round`, `floor` or `ceiling`.
    """

    type: IntegerType
    lower: float
    upper: float
    rounding: str
    units: str = ""

    @property
    def ratio(self) -> tuple[float, int]:
        """The step as dividend and divisor, for code with a division."""
        return self.upper - self.lower, self.type.upper

    @cached_property
    def step(self) -> float:
        """Difference between the values of neighbouring integers."""
        span, steps = self.ratio
        return span / steps

    def value_of(self, integer: int) -> float:
        """Returns the value that an integer on the wire means."""
        return integer * self.step + self.lower

    def integer_of(self, value: float) -> int:
        """Returns the integer on the wire that stands for a value.

        A limit that went through text or through `value_of` may miss its end by a trifle.

        Raises:
            ValueError: The value lies outside of the limits, or is no number at all.
        """
        try:
            position = (value - self.lower) / self.step
        except OverflowError:
            position = math.inf
        slack = _SLACK + self.type.upper * 2.0**-50
        if not -slack <= position <= self.type.upper + slack:
            raise ValueError(f"the value is not within {self.lower!r} .. {self.upper!r}")
        return min(max(self._rounded(position), 0), self.type.upper)

    def _rounded(self, position: float) -> int:
        if self.rounding == "floor":
            return math.floor(position + _SLACK)
        if self.rounding == "ceiling":
            return math.ceil(position - _SLACK)
        return round(position)

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


Number: TypeAlias = Integer | Real | Scaled
