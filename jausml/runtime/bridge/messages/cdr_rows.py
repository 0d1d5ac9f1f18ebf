"""Elements of sequences of ROS messages that lie alike in CDR, as structured arrays of numpy."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy

from ...conversions.columns import as_column, in_range
from ...conversions.types import UnevenError
from . import cdr

if TYPE_CHECKING:
    from collections.abc import Iterator


_CODES = {
    "boolean": "?",
    "octet": "B",
    "float": "f",
    "double": "d",
    **{f"int{8 << power}": code for power, code in enumerate("bhiq")},
    **{f"uint{8 << power}": code for power, code in enumerate("BHIQ")},
}
_SIZES = {code: struct.calcsize(f"<{code}") for code in _CODES.values()}
_LENGTH = 4
"""Bytes of the length of a text."""


Leaves = tuple[tuple[str, str], ...]
"""Paths and format characters of the numbers and texts (`s`) of a message, in order."""


@lru_cache(256)
def leaves_of(cls: Any) -> Leaves | None:
    """Returns the numbers and texts of a message; None where it has an array."""
    found: list[tuple[str, str]] = []
    nested = nested_in(cls)
    for name, kind in cls.LAYOUT.items():
        if kind in nested:
            inner = leaves_of(nested[kind])
            if inner is None:
                return None
            found += [(f"{name}.{path}", code) for path, code in inner]
        elif kind in _CODES or kind == "string":
            found.append((name, _CODES.get(kind, "s")))
        else:
            return None
    return tuple(found)


@lru_cache(256)
def _type(leaves: Leaves, lengths: tuple[int, ...], mark: str) -> numpy.dtype[Any] | None:
    """Returns the structured type of elements whose texts have given lengths.

    It is that of an element at a multiple of the largest alignment; None where the next one would
    not be at one.
    """
    names, formats, offsets = [], [], []
    at, widest, texts = 0, 1, iter(lengths)
    for path, code in leaves:
        size = _LENGTH if code == "s" else _SIZES[code]
        widest = max(widest, size)
        at += -at % size
        names.append(path)
        offsets.append(at)
        formats.append(f"{mark}u4" if code == "s" else f"{mark}{code}")
        at += size
        if code == "s":
            length = next(texts)
            names.append(f"{path}.text")
            offsets.append(at)
            formats.append(f"S{length}")
            at += length
    if at % widest:
        return None
    return numpy.dtype(
        {"names": names, "formats": formats, "offsets": offsets, "itemsize": at},
        metadata={"alignment": widest},
    )


@dataclass(frozen=True)
class CdrRows:
    """Elements of a sequence that lie alike.

    Attributes:
        rows: The elements, but the first where that has other padding, as it begins elsewhere.
        order: Byte order of the rows.
    """

    message: Any
    rows: Any
    head: tuple[Any, ...]
    order: int

    def __len__(self) -> int:
        return len(self.head) + len(self.rows)

    def element(self, index: int) -> Any:
        """Makes one of them."""
        if index < len(self.head):
            return self.elements()[0]
        at = index - len(self.head)
        data = cdr.HEADER + self.rows[at : at + 1].tobytes()
        return self.message._read(data, len(cdr.HEADER), self.order)[0]  # noqa: SLF001 - of the codec

    def elements(self) -> list[Any]:
        """Makes all of them."""
        data = cdr.HEADER + self.rows.tobytes()
        made, offset = list(self.head), len(cdr.HEADER)
        for _ in range(len(self.rows)):
            each, offset = self.message._read(data, offset, self.order)  # noqa: SLF001 - of the codec
            made.append(each)
        return made

    def columns(self) -> Any:
        """Returns the element of columns."""
        return _Columns(self, "", self.message)

    def column(self, path: str) -> Any:
        """Returns the numbers at a path of all elements."""
        column = as_column(self.rows[path])
        if self.head:
            column = numpy.concatenate(([attrgetter(path)(self.head[0])], column))
        return column

    def write(self, append: cdr.Append, offset: int) -> int:
        """Appends the elements, which begin at an offset; returns the offset behind them."""
        rows = self.rows
        is_as_written = self.order == cdr.LITTLE and not self.head
        if is_as_written and not _fits(rows.dtype, offset):
            # The first one has other padding, as it does not begin at a multiple of its alignment.
            offset = self.element(0)._write(append, offset)  # noqa: SLF001 - of the codec
            rows = rows[1:]
        if is_as_written and _fits(rows.dtype, offset):
            append(rows.tobytes())
            return offset + int(rows.nbytes)
        for each in self.elements()[len(self) - len(rows) - len(self.head) :]:
            offset = each._write(append, offset)  # noqa: SLF001 - of the codec
        return offset


class _Columns:
    """An element of columns, whose attributes are made when they are asked for.

    Args:
        path: Where it stands in each, with a dot at its end; empty for the whole element.
    """

    def __init__(self, rows: CdrRows, path: str, message: Any) -> None:
        self._rows = rows
        self._path = path
        self._message = message

    def __getattr__(self, name: str) -> Any:
        kind = self._message.LAYOUT[name]
        made: Any
        if kind in _CODES:
            made = self._rows.column(self._path + name)
        elif kind == "string":
            raise UnevenError
        else:
            made = _Columns(self._rows, f"{self._path}{name}.", nested_in(self._message)[kind])
        setattr(self, name, made)
        return made


@lru_cache(256)
def nested_in(cls: Any) -> dict[str, Any]:
    """Returns the classes of the messages inside a message, by what its layout calls them."""
    return {each.TYPE.replace("/msg/", "/"): each for each in cls.NESTED}


def _fits(kind: numpy.dtype[Any], offset: int) -> bool:
    """Whether elements that begin at an offset have the padding of their structured type."""
    widest: int = kind.metadata["alignment"]  # type: ignore[index]
    return (offset - len(cdr.HEADER)) % widest == 0


def _columns(cls: Any, values: Iterator[Any]) -> Any:
    nested = nested_in(cls)
    return cls(
        *(
            _columns(nested[kind], values) if kind in nested else next(values)
            for kind in cls.LAYOUT.values()
        )
    )


def read(cls: Any, data: bytes, offset: int, count: int, order: int) -> tuple[CdrRows, int] | None:
    """Returns the elements of a sequence, and the offset behind them; None where they are uneven.

    Args:
        order: Byte order.
    """
    leaves = leaves_of(cls)
    if leaves is None:
        return None
    mark = ">" if order else "<"
    lengths = _lengths(leaves, data, offset, mark)
    kind = None if lengths is None else _type(leaves, lengths, mark)
    if kind is None or lengths is None:
        return None
    head: tuple[Any, ...] = ()
    if not _fits(kind, offset):
        first, offset = cls._read(data, offset, order)
        head = (first,)
    end = offset + (count - len(head)) * kind.itemsize
    if not _fits(kind, offset) or end > len(data):
        return None
    rows = numpy.frombuffer(data, kind, count - len(head), offset)
    for (path, _), length in zip([each for each in leaves if each[1] == "s"], lengths, strict=True):
        start = offset + kind.fields[f"{path}.text"][1]  # type: ignore[index]
        if not (rows[path] == length).all():
            return None
        if data[start + length - 1 : end : kind.itemsize].count(0) != len(rows):
            return None
    return CdrRows(cls, rows, head, order), end


def _lengths(leaves: Leaves, data: bytes, offset: int, mark: str) -> tuple[int, ...] | None:
    """The lengths of the texts of the first element."""
    found, at = [], offset - len(cdr.HEADER)
    for _, code in leaves:
        size = _LENGTH if code == "s" else _SIZES[code]
        at += -at % size
        if code == "s":
            place = at + len(cdr.HEADER)
            if place + _LENGTH > len(data):
                return None
            (length,) = struct.unpack_from(f"{mark}I", data, place)
            if not 0 < length <= len(data):
                return None
            found.append(length)
            at += length
        at += size
    return tuple(found)


def made(element: Any, count: int) -> CdrRows:
    """Returns the elements that an element of columns is."""
    cls: Any = type(element)
    leaves = leaves_of(cls)
    if leaves is None:
        raise UnevenError
    columns: dict[str, Any] = {}
    values: list[Any] = []
    lengths: list[int] = []
    for path, code in leaves:
        value: Any = attrgetter(path)(element)
        if code == "s":
            lengths.append(len(value.encode()) + 1)
        elif isinstance(value, numpy.ndarray):
            columns[path] = in_range(value, code)
            value = columns[path][0].item()
        values.append(value)
    kind = _type(leaves, tuple(lengths), "<")
    if kind is None:
        raise UnevenError
    # All but the columns is the same in each.
    parts: list[bytes] = []
    _columns(cls, iter(values))._write(parts.append, len(cdr.HEADER))  # noqa: SLF001 - of the codec
    rows = numpy.frombuffer(bytearray(b"".join(parts)) * count, kind)
    for path, column in columns.items():
        rows[path] = column
    return CdrRows(cls, rows, (), cdr.LITTLE)
