"""Lists of records that lie alike: the bytes that they are, until somebody asks for an element.

What goes over such a list as a whole, as a bridge does, never makes its elements.
"""

from __future__ import annotations

import struct
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar, overload

from .codec import check_presence

T = TypeVar("T")

FEWEST = 8
"""Elements below which making each of them costs less than going over all as a whole."""

_MOST_LAYOUTS = 256


class Alike(Protocol[T]):
    """Elements that lie alike."""

    def __len__(self) -> int:
        """How many they are."""

    def element(self, index: int) -> T:
        """Makes one of them, of an index from 0."""

    def elements(self) -> list[T]:
        """Makes all of them."""


class Records(MutableSequence[T]):
    """A list whose elements are made when one of them is asked for.

    It has no method that a list has not, and is equal to a list of equal elements.
    """

    __slots__ = ("_alike", "_made", "_single")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, alike: Alike[T]) -> None:
        self._alike: Alike[T] | None = alike
        self._made: list[T] = []
        self._single: dict[int, T] = {}

    @property
    def alike(self) -> Alike[T] | None:
        """The elements as a whole; None once all were made or one has changed."""
        alike = self._alike
        if alike is not None and self._single:
            made = ((alike.element(index), each) for index, each in self._single.items())
            if any(one != other for one, other in made):
                self._make()
        return self._alike

    def _make(self) -> list[T]:
        if self._alike is not None:
            self._made = self._alike.elements()
            for index, each in self._single.items():
                self._made[index] = each
            self._alike = None
        return self._made

    def __len__(self) -> int:
        return len(self._made if self._alike is None else self._alike)

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> list[T]: ...
    def __getitem__(self, index: int | slice) -> T | list[T]:
        alike = self._alike
        if alike is None or not isinstance(index, int):
            return self._make()[index]
        place = index + len(alike) if index < 0 else index
        if not 0 <= place < len(alike):
            raise IndexError(index)
        if place not in self._single:
            self._single[place] = alike.element(place)
        return self._single[place]

    def __setitem__(self, index: Any, value: Any) -> None:
        self._make()[index] = value

    def __delitem__(self, index: int | slice) -> None:
        del self._make()[index]

    def __iter__(self) -> Any:
        return iter(self._make())

    def insert(self, index: int, value: T) -> None:
        """Inserts an element before the one of an index."""
        self._make().insert(index, value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, list | Records):
            return NotImplemented
        return self._make() == list(other)

    def __repr__(self) -> str:
        return repr(self._make())


class Record(Protocol):
    """A class of records of numbers, as generated messages have them."""

    ROW: RowLayout

    def write_to(self, out: bytearray) -> None:
        """Appends the fields."""

    @classmethod
    def read_from(cls, buffer: bytes, offset: int) -> tuple[Any, int]:
        """Reads the fields from an offset; returns them and the offset after them."""


@dataclass(frozen=True)
class Number:
    """A number of a record.

    Attributes:
        attribute: Its attribute.
        code: Its format character in `struct`.
        least: Least value that is written.
        greatest: Greatest value that is written.
        step: Value of an integer on the wire, which counts from `least`; 0 where the number stands
            there as it is (AS5684 scale_range).
        bit: Its bit in the presence vector; 0 where it is always there.
    """

    attribute: str
    code: str
    least: float
    greatest: float
    step: float = 0.0
    bit: int = 0


@dataclass(frozen=True)
class Stamp:
    """A time stamp of a record, which is a bit field of 32 bits.

    Attributes:
        attribute: Its attribute.
        bit: Its bit in the presence vector; 0 where it is always there.
    """

    attribute: str
    bit: int = 0
    code: str = "I"


class RowLayout:
    """How the fields of a record follow each other.

    Attributes:
        fields: The fields in order.
        presence: Format character of the presence vector; empty without one.
        known: The bits of the presence vector that fields use.
    """

    def __init__(self, *fields: Number | Stamp, presence: str = "") -> None:
        self.fields = fields
        self.presence = presence
        self.known = sum(each.bit for each in fields)
        self.vector = struct.Struct(f"<{presence}")
        self._sizes: dict[int, int] = {}

    def present(self, vector: int) -> Sequence[Number | Stamp]:
        """Returns the fields that a presence vector says are there."""
        return [each for each in self.fields if not each.bit or each.bit & vector]

    def size(self, vector: int) -> int:
        """Returns the bytes of a record with a presence vector."""
        if vector not in self._sizes:
            if len(self._sizes) >= _MOST_LAYOUTS:
                self._sizes.clear()
            codes = "".join(each.code for each in self.present(vector))
            self._sizes[vector] = struct.calcsize(f"<{self.presence}{codes}")
        return self._sizes[vector]


@dataclass(frozen=True)
class Rows:
    """Records of numbers one after the other, with the same fields in each.

    Attributes:
        record: Their class, a `Record`.
        data: Their bytes.
        count: How many they are.
        vector: The presence vector of each.
    """

    record: Any
    data: bytes
    count: int
    vector: int = 0

    def __len__(self) -> int:
        return self.count

    def element(self, index: int) -> Any:
        """Makes one of them."""
        size = len(self.data) // self.count
        return self.record.read_from(self.data, index * size)[0]

    def elements(self) -> list[Any]:
        """Makes all of them."""
        return _elements(self.record, self.data, 0, self.count)[0]


def read_records(
    element: type[T], buffer: bytes, offset: int, count: int
) -> tuple[MutableSequence[T], int]:
    """Reads the elements of a list; returns them and the offset after them.

    Args:
        element: Their class, a `Record`.
        buffer: The payload.
        offset: Where the first one begins.
        count: How many there are.

    Raises:
        DecodeError: An element has fields that nobody knows.
        struct.error: The payload ends too early.
    """
    rows = _alike(element, buffer, offset, count) if count >= FEWEST else None
    if rows is None:
        return _elements(element, buffer, offset, count)
    return Records(rows), offset + len(rows.data)


def write_records(records: Sequence[Any], out: bytearray) -> None:
    """Appends the elements of a list, each a `Record`."""
    rows = records.alike if type(records) is Records else None
    if isinstance(rows, Rows):
        out += rows.data
        return
    for each in records:
        each.write_to(out)


def _elements(element: Any, buffer: bytes, offset: int, count: int) -> tuple[list[Any], int]:
    made = []
    for _ in range(count):
        each, offset = element.read_from(buffer, offset)
        made.append(each)
    return made, offset


def _alike(element: Any, buffer: bytes, offset: int, count: int) -> Rows | None:
    """The elements as a whole, if all have the same presence vector and all are there."""
    layout: RowLayout = element.ROW
    vector, width = 0, layout.vector.size
    if width:
        (vector,) = layout.vector.unpack_from(buffer, offset)
        check_presence(vector, layout.known, element.__qualname__)
    size = layout.size(vector)
    end = offset + count * size
    if end > len(buffer):
        return None
    for at in range(offset, offset + width):
        if buffer[at:end:size].count(buffer[at]) != count:
            return None
    return Rows(element, buffer[offset:end], count, vector)
