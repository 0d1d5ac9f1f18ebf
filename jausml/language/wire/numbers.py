"""Numeric types of the wire, little endian (SAE AS5684, field_type)."""

from __future__ import annotations

import struct
from dataclasses import dataclass


@dataclass(frozen=True)
class IntegerType:
    """An integer type.

    Attributes:
        name: Its name in the metamodel, e.g. `uint16`.
        format: Its struct format.
        size: Bytes.
        lower: Smallest integer.
        upper: Largest integer.
    """

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
    """A floating point type (IEEE 754).

    Attributes:
        name: Its name in the metamodel, e.g. `float32`.
        format: Its struct format.
        size: Bytes.
        largest: Largest finite number.
    """

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

UNSIGNED = {name: each for name, each in INTEGERS.items() if each.is_unsigned}
"""The types of counts, tags, presence vectors, bit fields and scaled numbers."""

REALS = {
    "float32": RealType("float32", "f", 4, 3.4028234663852886e38),
    "float64": RealType("float64", "d", 8, 1.7976931348623157e308),
}
"""The floating point types by their names."""
