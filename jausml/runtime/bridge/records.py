"""Elements of lists as structured arrays of numpy, where all lie alike.

Few elements are a list of rows as they are without: what numpy needs for a call pays for many.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy

from .messages.layouts import CdrRows, PresenceLayouts

if TYPE_CHECKING:
    Rows: TypeAlias = Any
    """Tuples in a list, or a structured array."""

LEAST = 16
"""Fewest elements that are worth an array."""

_KEPT = 256
_TYPES = {"B": "u1", "H": "u2", "I": "u4", "b": "i1", "h": "i2", "i": "i4", "f": "f4", "d": "f8"}


def record(layout: struct.Struct, names: tuple[str, ...], mark: str = "<") -> numpy.dtype[Any]:
    """Returns the type of records whose numbers a layout has.

    Args:
        layout: Letters of `struct`, and room.
        names: Names of the numbers.
        mark: The order of their bytes.
    """
    formats, offsets, at = [], [], 0
    text = layout.format.lstrip("<>")
    while text:
        digits = len(text) - len(text.lstrip("0123456789"))
        count, letter, text = int(text[:digits] or 1), text[digits], text[digits + 1 :]
        size = struct.calcsize(f"<{letter}")
        if letter in _TYPES:
            formats += [f"{mark}{_TYPES[letter]}"] * count
            offsets += [at + size * index for index in range(count)]
        at += size * count
    return numpy.dtype(
        {"names": names, "formats": formats, "offsets": offsets, "itemsize": layout.size}
    )


class PresenceRecords:
    """Elements of a list of JAUS as an array where there are many with the same presence vector."""

    def __init__(self, layouts: PresenceLayouts, *names: str) -> None:
        """Names the fields.

        Args:
            layouts: Layouts by presence vector.
            *names: Names of the fields that are wanted.
        """
        self._layouts = layouts
        self._names = names
        self._records: dict[bytes, numpy.dtype[Any] | None] = {}

    def rows(self, data: bytes, offset: int, count: int) -> tuple[Rows, int]:
        """Returns the values of each element, and where the last one ends.

        They are an array where none of the fields is absent. Arguments and errors are those of
        `PresenceLayouts.rows`.
        """
        if count >= LEAST:
            vector, end = self._layouts.alike(data, offset, count)
            kind = self._record(vector) if vector is not None else None
            if kind is not None:
                return numpy.frombuffer(data, kind, count, offset), end
        return self._layouts.rows(data, offset, count)

    def _record(self, vector: bytes) -> numpy.dtype[Any] | None:
        """Returns the type of elements with a presence vector; None where a field is absent."""
        if vector in self._records:
            return self._records[vector]
        layout = self._layouts[vector]
        kind = None if "0s" in layout.format else record(layout, self._names)
        if len(self._records) < _KEPT:
            self._records[vector] = kind
        return kind


class CdrRecordRows(CdrRows):
    """Elements of a sequence of CDR that lie alike, as an array where there are many."""

    def __init__(self, names: tuple[str, ...], *fields: str) -> None:
        """Names the fields.

        Args:
            names: Names of those that are wanted.
            *fields: As those of `CdrRows`.
        """
        super().__init__(*fields)
        self._names = names
        self._records: dict[struct.Struct, numpy.dtype[Any]] = {}

    def read_all(
        self, data: bytes, offset: int, size: int, first: Rows, count: int, order: int
    ) -> tuple[Rows, int]:
        """Returns the first element and those behind it, and where the last one ends.

        There is the first alone where the others do not lie alike.

        Args:
            data: The message.
            offset: Where the first element ends.
            size: Size of its text.
            first: The first element, in a list.
            count: Number of elements, with the first one.
            order: 0 for big endian, 1 for little endian.
        """
        if count < LEAST:
            others, end = self.read(data, offset, size, count - 1, order)
            return first + others, end
        layout, end = self.alike(data, offset, size, count - 1, order)
        if layout is None:
            return first, offset
        kind = self._records.get(layout)
        if kind is None:
            kind = record(layout, self._names, "<" if order else ">")
            if len(self._records) < _KEPT:
                self._records[layout] = kind
        return numpy.frombuffer(layout.pack(*first[0]) + data[offset:end], kind), end


class CdrRecords(dict[int, "tuple[numpy.dtype[Any], bytes, int, int, int]"]):
    """Elements of a sequence of CDR (XCDR1, little endian) that are written at once.

    They have at most one text, the same in all, and end with a number of 8 bytes: so all but the
    first begin at a multiple of 8. The key is the length of the text.
    """

    def __init__(self, *fields: tuple[str, str, float]) -> None:
        """Names the fields.

        Args:
            *fields: Name, letter and usual value of each number; the letter of the text is `s`.
        """
        super().__init__()
        self._fields = fields

    def make(self, count: int, text: str = "") -> Any:
        """Returns an array of so many elements, which have the usual values.

        Args:
            count: Number of elements.
            text: Their text.
        """
        found = text.encode()
        kind, template, begin, _, _ = self[len(found)]
        if found:
            template = template[:begin] + found + template[begin + len(found) :]
        return numpy.frombuffer(bytearray(template) * count, kind)

    def put(self, records: Any, out: bytearray, text: str = "") -> None:
        """Appends elements to a message, whose next octet is at a multiple of 4.

        Args:
            records: The elements.
            out: The message.
            text: Their text.
        """
        _, _, _, head, eight = self[len(text.encode())]
        raw = records.tobytes()
        if raw:
            out += raw[:head]
            out += bytes(4 - len(out) & 7)
            out += raw[eight:]

    def __missing__(self, length: int) -> tuple[numpy.dtype[Any], bytes, int, int, int]:
        """Returns the layout for a text of a length that was not seen before.

        That is the type, an element with the usual values, where its text stands, where its first
        numbers end, and where the first of 8 bytes begins.
        """
        template = bytearray()
        columns: list[tuple[str, str, int]] = []
        begin = head = eight = 0
        for name, letter, usual in self._fields:
            size = 4 if letter == "s" else struct.calcsize(f"<{letter}")
            if size == 8 and not eight:
                head, eight = len(template), len(template) + -len(template) % 8
            template += bytes(-len(template) % size)
            if name:
                columns.append((name, f"<{_TYPES[letter]}", len(template)))
            if letter == "s":
                template += struct.pack("<I", length + 1)
                begin = len(template)
                template += bytes(length + 1)
            else:
                template += struct.pack(f"<{letter}", usual)
        names, formats, offsets = zip(*columns, strict=True)
        kind = numpy.dtype(
            {"names": names, "formats": formats, "offsets": offsets, "itemsize": len(template)}
        )
        found = kind, bytes(template), begin, head, eight
        if len(self) < _KEPT:
            self[length] = found
        return found
