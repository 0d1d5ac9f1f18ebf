"""CDR, the serialized form of ROS messages: functions for the light classes of a bridge.

The bytes are those of XCDR version 1 (OMG DDS-XTypes 1.3, 7.4), as rmw implementations exchange
them: a header of four bytes with the byte order, then the fields in order, each at a multiple of
its size, counted from the end of the header. Functions that read raise DecodeError, those that
write raise EncodeError. An offset counts bytes from the begin of the header.
"""

from __future__ import annotations

import struct
import sys
from array import array
from collections.abc import Callable, MutableSequence, Sequence
from typing import Any, TypeAlias, TypeVar

from ...wire.message import DecodeError, EncodeError

Append: TypeAlias = Callable[[bytes], object]  # takes the next bytes of a message
Reals: TypeAlias = MutableSequence[float]  # array or sequence of real numbers
Integers: TypeAlias = MutableSequence[int]  # array or sequence of integers
Truths: TypeAlias = MutableSequence[bool]  # array or sequence of truth values
T = TypeVar("T")
Messages: TypeAlias = MutableSequence[T]  # array or sequence of messages
HEADER = b"\0\1\0\0"  # of a message in little-endian order
LITTLE, BIG = 0, 8  # byte orders: index of the first layout of a `run`
ORDERS = {b"\0\1": LITTLE, b"\0\0": BIG}  # byte orders by the first two bytes of a message

_NATIVE = LITTLE if sys.byteorder == "little" else BIG
_PADDING = b"\0" * 8
_UTF_16 = f"utf-16-{sys.byteorder[0]}e"
_SIZES = {code: struct.calcsize(f"<{code}") for code in "?bBhHiIqQfd"}


# ------------------------------------------------------------------ numbers in a row


def run(items: str) -> tuple[struct.Struct, ...]:
    """Returns the layouts of consecutive numbers for each offset of the first one.

    Args:
        items: Format characters of `struct` separated by blanks; with a count before it, one stands
            for an array as bytes.

    Returns:
        Layouts by offset modulo 8: eight little-endian ones, then eight big-endian ones.
    """
    words = items.split()
    return tuple(
        struct.Struct(_format(words, offset, mark)) for mark in "<>" for offset in range(8)
    )


def _format(words: Sequence[str], offset: int, mark: str) -> str:
    position, parts = offset - len(HEADER), [mark]
    for word in words:
        code, count = word[-1], word[:-1]
        size = _SIZES[code]
        padding = -position % size
        parts.append("x" * padding)
        parts.append(f"{int(count) * size}s" if count else code)
        position += padding + size * int(count or 1)
    return "".join(parts)


def several(make: Callable[[], T], count: int) -> list[T]:
    """Returns a list of `count` new elements."""
    return [make() for _ in range(count)]


def filled(code: str, values: Sequence[Any]) -> MutableSequence[Any]:
    """Returns a new array of values."""
    return elements(code, raw(code, values), LITTLE)


def zeros(code: str, count: int) -> MutableSequence[Any]:
    """Returns a new array of zeros."""
    return elements(code, bytes(count * _SIZES[code]), LITTLE)


def elements(code: str, raw: bytes, order: int) -> MutableSequence[Any]:
    """Returns the elements in bytes: octets as a bytearray, bools as a list, others as an array."""
    if code == "B":
        return bytearray(raw)
    if code == "?":
        return [raw_value != 0 for raw_value in raw]
    values = array(code, raw)
    if order != _NATIVE:
        values.byteswap()
    return values


def vector(
    data: bytes, offset: int, count: int, code: str, order: int
) -> tuple[MutableSequence[Any], int]:
    """Returns the elements of a sequence of numbers, and the offset behind it."""
    if not count:
        return elements(code, b"", order), offset
    size = _SIZES[code]
    offset += (len(HEADER) - offset) % size
    end = offset + count * size
    if end > len(data):
        raise DecodeError("sequence", f"{count} elements, but {len(data) - offset} bytes")
    return elements(code, data[offset:end], order), end


def raw(code: str, values: Any, count: int | None = None) -> bytes:
    """Returns the bytes of an array or sequence of numbers.

    Args:
        values: The elements: bytes, an array, or any sequence of numbers.
        count: Length of an array; None for a sequence.

    Raises:
        EncodeError: An array has another length.
        struct.error: An element is no number of the type.
    """
    if count is not None and len(values) != count:
        raise EncodeError("array", f"{len(values)} elements, not {count}")
    if code == "B" and isinstance(values, bytes | bytearray):
        return bytes(values)
    if isinstance(values, array) and values.typecode == code and _NATIVE == LITTLE:
        return values.tobytes()
    if code == "B":
        values = map(octet, values)
        return bytes(values)
    return struct.pack(f"<{len(values)}{code}", *values)


def put(append: Append, offset: int, octets: bytes, size: int) -> int:
    """Appends the elements of a sequence of numbers; returns the offset behind them."""
    if not octets:
        return offset
    padding = (len(HEADER) - offset) % size
    append(_PADDING[:padding])
    append(octets)
    return offset + padding + len(octets)


def octet(value: Any) -> int:
    """Returns the number of an octet, which is a number or, in rclpy, bytes of length 1."""
    return value[0] if isinstance(value, bytes) and len(value) == 1 else value


# ------------------------------------------------------------------ texts


def text(data: bytes, offset: int, length: int) -> tuple[str, int]:
    """Returns a text and the offset behind it; bytes that are no UTF-8 are replaced."""
    end = offset + length
    if end > len(data):
        raise DecodeError("string", f"{length} bytes, but {len(data) - offset} are left")
    if length and data[end - 1]:
        raise DecodeError("string", "no zero at its end")
    return str(data[offset : end - 1], "utf-8", "replace") if length else "", end


def encoded(value: str, most: int = 0) -> bytes:
    """Returns the bytes of a text with a final zero; a `most` of 0 is no limit."""
    if most and len(value) > most:
        raise EncodeError("string", f"{len(value)} characters, more than {most}")
    return value.encode() + b"\0"


def wide_text(data: bytes, offset: int, count: int, order: int) -> tuple[str, int]:
    """Returns a text of `count` units of UTF-16, four bytes each, and the offset behind it."""
    units, end = vector(data, offset, count, "I", order)
    try:
        return array("H", units).tobytes().decode(_UTF_16, "replace"), end
    except OverflowError as error:
        raise DecodeError("wstring", str(error)) from error


def wide(value: str, most: int = 0) -> bytes:
    """Returns the bytes of a wide text; a `most` of 0 is no limit."""
    if most and len(value) > most:
        raise EncodeError("wstring", f"{len(value)} characters, more than {most}")
    units = array("H", value.encode(_UTF_16))
    return struct.pack(f"<{len(units)}I", *units)


_LENGTH = run("I")


def texts(data: bytes, offset: int, count: int, order: int) -> tuple[list[str], int]:
    """Returns consecutive texts, and the offset behind them."""
    return _read_texts(data, offset, count, order, lambda start, length: text(data, start, length))


def wide_texts(data: bytes, offset: int, count: int, order: int) -> tuple[list[str], int]:
    """Returns consecutive wide texts, and the offset behind them."""
    return _read_texts(
        data, offset, count, order, lambda start, length: wide_text(data, start, length, order)
    )


def _read_texts(
    data: bytes, offset: int, count: int, order: int, read: Callable[[int, int], tuple[str, int]]
) -> tuple[list[str], int]:
    check_count(data, offset, count, 4)
    strings = []
    for _ in range(count):
        layout = _LENGTH[offset & 7 | order]
        (length,) = layout.unpack_from(data, offset)
        text, offset = read(offset + layout.size, length)
        strings.append(text)
    return strings, offset


def put_texts(values: Sequence[str], append: Append, offset: int, most: int = 0) -> int:
    """Appends texts; returns the offset behind them. A `most` of 0 is no limit."""
    for value in values:
        octets = encoded(value, most)
        layout = _LENGTH[offset & 7]
        append(layout.pack(len(octets)))
        append(octets)
        offset += layout.size + len(octets)
    return offset


def put_wide_texts(values: Sequence[str], append: Append, offset: int, most: int = 0) -> int:
    """Appends wide texts as `put_texts` does."""
    for value in values:
        octets = wide(value, most)
        layout = _LENGTH[offset & 7]
        append(layout.pack(len(octets) // 4))
        append(octets)
        offset += layout.size + len(octets)
    return offset


# ------------------------------------------------------------------ counts


def check_count(data: bytes, offset: int, count: int, least: int) -> None:
    """Raises DecodeError if there are too few bytes for `count` elements of `least` bytes."""
    if count * least > len(data) - offset:
        raise DecodeError("sequence", f"{count} elements, but {len(data) - offset} bytes")


def check_bound(count: int, most: int) -> None:
    """Raises DecodeError if a bounded sequence has more than `most` elements."""
    if count > most:
        raise DecodeError("sequence", f"{count} elements, more than {most}")


def at_most(values: Sequence[T], most: int) -> Sequence[T]:
    """Returns the elements of a bounded sequence; raises EncodeError for more than `most`."""
    if len(values) > most:
        raise EncodeError("sequence", f"{len(values)} elements, more than {most}")
    return values


def exactly(values: Sequence[T], count: int) -> Sequence[T]:
    """Returns the elements of an array; raises EncodeError if they are not `count`."""
    if len(values) != count:
        raise EncodeError("array", f"{len(values)} elements, not {count}")
    return values
