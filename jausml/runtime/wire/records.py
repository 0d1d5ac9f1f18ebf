"""Records of one octet each, such as the cells of a grid, kept as bytes until one is accessed.

A bridge, which converts such a list as a whole, never makes the records.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from typing import Any, NamedTuple, TypeVar, overload

T = TypeVar("T")
_MANY = 8  # records from which on it is cheaper to keep bytes than to make all


class Octet(NamedTuple):
    """The only field of a record of one octet."""

    attribute: str  # name of its attribute
    is_signed: bool = False  # whether its range is -128 .. 127


class OctetRecords(MutableSequence[T]):
    """A list of records of one octet, which are all made when one of them is accessed.

    It has only methods of a list, and is equal to a list of equal records.

    Attributes:
        record: The class of the records, whose `OCTET` is their field.
        octets: The encoded records; None once they were made, as they may have changed.
    """

    __slots__ = ("_records", "octets", "record")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, record: type[T], octets: bytes) -> None:
        self.record: Any = record
        self.octets: bytes | None = octets
        self._records: list[T] = []

    def _make(self) -> list[T]:
        if self.octets is not None:
            octets, self.octets = self.octets, None
            self._records = [self.record.read_from(octets, at)[0] for at in range(len(octets))]
        return self._records

    def __len__(self) -> int:
        return len(self._records if self.octets is None else self.octets)

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> list[T]: ...
    def __getitem__(self, index: int | slice) -> T | list[T]:
        return self._make()[index]

    def __setitem__(self, index: Any, value: Any) -> None:
        self._make()[index] = value

    def __delitem__(self, index: int | slice) -> None:
        del self._make()[index]

    def __iter__(self) -> Any:
        return iter(self._make())

    def insert(self, index: int, value: T) -> None:
        """Inserts a record before the one of an index."""
        self._make().insert(index, value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, list | OctetRecords):
            return NotImplemented
        return self._make() == list(other)

    def __repr__(self) -> str:
        return repr(self._make())


def octet_records(record: type[T], octets: bytes) -> MutableSequence[T]:
    """Returns the records of octets; many of them are made only when one is accessed."""
    records = OctetRecords(record, octets)
    return records if len(octets) >= _MANY else [*records]


def write_records(records: Sequence[Any], out: bytearray) -> None:
    """Appends records of one octet to the encoded bytes."""
    if isinstance(records, OctetRecords) and records.octets is not None:
        out += records.octets
        return
    for record in records:
        record.write_to(out)
