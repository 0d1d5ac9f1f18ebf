"""Records of one octet each, such as the cells of a grid: bytes, until somebody asks for a record.

What goes over such a list as a whole, as a bridge does, never makes its records.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from typing import Any, NamedTuple, TypeVar, overload

T = TypeVar("T")
_MANY = 8  # records from which on it costs less to leave them bytes than to make each


class Octet(NamedTuple):
    """The only field of a record that is one octet on the wire."""

    attribute: str  # its attribute
    is_signed: bool = False  # whether it is a number of -128 .. 127


class OctetRecords(MutableSequence[T]):
    """A list of records of one octet, all of which are made when one of them is asked for.

    It has no method that a list has not, and is equal to a list of equal records.

    Attributes:
        record: Their class, whose `OCTET` is their field.
        octets: The records on the wire; None once they were made, as they may have changed.
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
    """Returns the records that octets are: few at once, many when somebody asks for one."""
    records = OctetRecords(record, octets)
    return records if len(octets) >= _MANY else [*records]


def write_records(records: Sequence[Any], out: bytearray) -> None:
    """Appends records of one octet."""
    if isinstance(records, OctetRecords) and records.octets is not None:
        out += records.octets
        return
    for record in records:
        record.write_to(out)
