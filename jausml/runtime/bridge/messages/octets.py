"""Conversion of long lists of octets, such as the cells of a grid, in one step.

The lists are arrays of numbers in a ROS message, or JAUS records with one field of eight bits.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, MutableSequence, Sequence
from functools import lru_cache
from typing import Any

from ...base.api import JausError
from ...conversions import rasters
from ...wire.records import OctetRecords
from .limits import Limit


class Table:
    """The target octet of each source octet.

    Attributes:
        octets: The 256 target octets, as `bytes.translate` takes them.
        odd: An unused octet, by which source octets without a legal target are marked in the
            result; None if all have a target.
    """

    def __init__(
        self, convert: Callable[[float], float], lower: int, upper: int, *, is_signed: bool
    ) -> None:
        """Converts each octet; those outside of the limits, or with a JausError, have no target."""
        values_by_octet: dict[int, int] = {}
        for octet in range(256):
            try:
                value = convert(number(octet, is_signed=is_signed))
            except JausError:
                continue
            if lower <= value <= upper:
                values_by_octet[octet] = round(value) & 0xFF
        unused = set(range(256)).difference(values_by_octet.values())
        self.odd = min(unused) if len(values_by_octet) < 256 else None
        self.octets = bytes(values_by_octet.get(octet, self.odd or 0) for octet in range(256))


@lru_cache(64)
def _table(
    convert: Callable[[float], float],
    lower: int,
    upper: int,
    is_signed: bool,  # noqa: FBT001
) -> Table:
    return Table(convert, lower, upper, is_signed=is_signed)


def number(octet: int, *, is_signed: bool) -> int:
    """Returns the number of an octet."""
    return octet - 256 if is_signed and octet > 127 else octet


def each(
    limit: Limit[Any],
    field: str,
    convert: Callable[[float], float],
    items: Sequence[Any],
    minimum: int,
    maximum: int,
    record: type[Any] | None = None,
) -> MutableSequence[Any]:
    """Returns the converted integers of octets.

    Args:
        limit: Policy for values outside of `minimum` .. `maximum`.
        field: The target field, for the policy.
        items: The octets: numbers, or records of one number.
        record: Class of the resulting records; None for numbers.

    Raises:
        ConversionError: An octet cannot be converted.
        OutOfRangeError: A value does not fit and drops the message.
    """
    raw, is_signed = _raw(items)
    table = _table(convert, minimum, maximum, is_signed)
    octets = raw.translate(table.octets)
    if table.odd is not None and table.odd in octets:
        limited = bytearray(octets)
        position = octets.find(table.odd)
        while position >= 0:
            value = convert(number(raw[position], is_signed=is_signed))
            limited[position] = limit.integer(field, value, minimum, maximum) & 0xFF
            position = octets.find(table.odd, position + 1)
        octets = bytes(limited)
    if record is not None:
        return OctetRecords(record, octets)
    return array("b", octets) if minimum < 0 else bytearray(octets)


def reverse_rows(cells: Sequence[Any], columns: float) -> Sequence[Any]:
    """Returns the cells of a grid with the rows in the opposite order.

    Raises:
        ConversionError: The cells do not fill rows of `columns` cells.
    """
    if isinstance(cells, OctetRecords) and cells.octets is not None:
        return OctetRecords(cells.record, _reversed(cells.octets, len(cells), columns, 1))
    if isinstance(cells, array):
        data = _reversed(cells.tobytes(), len(cells), columns, cells.itemsize)
        return array(cells.typecode, data)
    if isinstance(cells, bytearray):
        return bytearray(_reversed(bytes(cells), len(cells), columns, 1))
    return rasters.reverse_rows(cells, columns)


def _reversed(data: bytes, count: int, columns: float, size: int) -> bytes:
    starts = rasters.row_starts(count, columns)
    width = int(columns) * size
    return b"".join(data[start * size : start * size + width] for start in starts)


def _raw(items: Sequence[Any]) -> tuple[bytes, bool]:
    """Returns octets as bytes, and whether they are signed."""
    if isinstance(items, OctetRecords) and items.octets is not None:
        return items.octets, items.record.OCTET.is_signed
    if isinstance(items, array):
        return items.tobytes(), items.typecode == "b"
    if isinstance(items, bytes | bytearray):
        return bytes(items), False
    # A list of records or numbers, from an override.
    values = [
        getattr(item, item.OCTET.attribute) if hasattr(item, "OCTET") else item for item in items
    ]
    is_signed = any(value < 0 for value in values)
    return array("b" if is_signed else "B", values).tobytes(), is_signed
