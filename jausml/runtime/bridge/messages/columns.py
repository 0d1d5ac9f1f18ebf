"""Elements of lists all at once: what a translation says of one is done with columns of numpy.

An element of columns is an object of the class of the elements, whose numbers are arrays: those of
all elements. What a function makes of it, where it treats all elements alike, is what it makes of
each. Where it does not, it raises `UnevenError`, and is called for each element instead.
"""

from __future__ import annotations

from array import array
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar

import numpy

from ...conversions.columns import as_column, fit, in_range, is_column
from ...conversions.types import UnevenError
from ...wire.codec import TimeStamp
from ...wire.records import Number, Records, Rows, Stamp
from ..light_message import LightMessage
from . import cdr, cdr_rows

if TYPE_CHECKING:
    from collections.abc import Callable, MutableSequence, Sequence


T = TypeVar("T")
Made = TypeVar("Made")

_ERRORS = (ArithmeticError, AttributeError, TypeError, ValueError)
_REAL = numpy.dtype("f8")
_LARGEST = {"B": 0xFF, "H": 0xFFFF, "I": 0xFFFFFFFF, "Q": 0xFFFFFFFFFFFFFFFF}
_STAMP = (
    ("milliseconds", 0, 0, 999),
    ("seconds", 10, 0, 59),
    ("minutes", 16, 0, 59),
    ("hour", 22, 0, 23),
    ("day", 27, 1, 31),
)
"""Parts of a time stamp: lowest bit, least and greatest value (`wire.time_stamp`)."""


def each(make: Callable[[T], Made], items: Sequence[T], code: str) -> MutableSequence[Made]:
    """Returns what a function makes of all elements of a list, which it is given at once.

    Args:
        make: Makes an element, or a number, of an element.
        code: Format character of the numbers that are made; empty for elements.
    """
    try:
        with numpy.errstate(all="ignore"):
            return _whole(make(columns_of(items)), len(items), code)
    except _ERRORS as error:
        raise UnevenError from error


def each_counted(
    make: Callable[[int, T], Made], items: Sequence[T], code: str
) -> MutableSequence[Made]:
    """Does the same with a function that is given the index of each element before it."""
    index: Any = numpy.arange(len(items))
    return each(lambda item: make(index, item), items, code)


def _whole(made: Any, count: int, code: str) -> MutableSequence[Any]:
    if code:
        return _numbers(made, count, code)
    if isinstance(made, LightMessage):
        return Records(cdr_rows.made(made, count))
    return Records(_rows(made, count))


def columns_of(items: Any) -> Any:
    """Returns the element of columns of a list, or the column of a list of numbers."""
    if type(items) is Records:
        alike = items.alike
        if isinstance(alike, Rows):
            return _element(alike)
        if isinstance(alike, cdr_rows.CdrRows):
            return alike.columns()
    elif isinstance(items, array):
        return as_column(numpy.frombuffer(items, items.typecode))
    elif isinstance(items, bytes | bytearray):
        return as_column(numpy.frombuffer(items, "u1"))
    raise UnevenError


def _numbers(made: Any, count: int, code: str) -> MutableSequence[Any]:
    """Returns what was made of all elements as an array of numbers of the ROS message."""
    whole = made if is_column(made) else numpy.full(count, made)
    return cdr.elements(code, in_range(whole, code).tobytes(), cdr.LITTLE)


# ------------------------------------------------------------------ records of JAUS


@lru_cache(256)
def _type(element: Any, vector: int) -> numpy.dtype[Any]:
    """Returns the structured type of records with a presence vector."""
    layout = element.ROW
    fields = [("presence", f"<{layout.presence}")] if layout.presence else []
    fields += [(each.attribute, f"<{each.code}") for each in layout.present(vector)]
    return numpy.dtype(fields)


def _element(rows: Rows) -> Any:
    found = numpy.frombuffer(rows.data, _type(rows.record, rows.vector))
    made = rows.record()
    for field in rows.record.ROW.fields:
        value: Any = None
        if not field.bit or field.bit & rows.vector:
            value = found[field.attribute]
            if isinstance(field, Stamp):
                value = TimeStamp.from_integer(as_column(value))  # type: ignore[arg-type]
            elif field.step:
                value = value * field.step
                if field.least:
                    value += field.least
            else:
                value = as_column(value)
        setattr(made, field.attribute, value)
    return made


def _rows(made: Any, count: int) -> Rows:
    record: Any = type(made)
    layout = record.ROW
    if len(layout.fields) == 1 and not layout.presence:
        (only,) = layout.fields
        values = _on_wire(only, getattr(made, only.attribute))
        if is_column(values):
            return Rows(record, values.astype(f"<{only.code}").tobytes(), count)
    values = [getattr(made, field.attribute) for field in layout.fields]
    vector = 0
    for field, value in zip(layout.fields, values, strict=True):
        if value is not None:
            vector |= field.bit
        elif not field.bit:
            raise UnevenError
    found = numpy.empty(count, _type(record, vector))
    if layout.presence:
        found["presence"] = vector
    for field, value in zip(layout.fields, values, strict=True):
        if value is not None:
            found[field.attribute] = _on_wire(field, value)
    return Rows(record, found.tobytes(), count, vector)


def _on_wire(field: Number | Stamp, value: Any) -> Any:
    """Returns a value as it stands on the wire."""
    if isinstance(field, Stamp):
        return _bits(value)
    if field.step:
        place = (value - field.least if field.least else value) / field.step
        if not _fits(place, 0.0, _LARGEST[field.code]):
            raise UnevenError
        return numpy.rint(place)
    is_whole = isinstance(value, int) or getattr(value, "dtype", _REAL).kind == "i"
    if not (is_whole or field.code in "fd") or not _fits(value, field.least, field.greatest):
        raise UnevenError
    return value


def _fits(values: Any, least: float, greatest: float) -> bool:
    return fit(values, least, greatest) if is_column(values) else least <= values <= greatest


def _bits(stamp: TimeStamp) -> Any:
    bits: Any = 0
    for name, place, least, most in _STAMP:
        part: Any = getattr(stamp, name)
        if not _fits(part, least, most):
            raise UnevenError
        bits = bits | part << place
    return bits
