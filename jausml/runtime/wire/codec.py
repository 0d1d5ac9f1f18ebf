"""Kinds of fields, and the checks of their values on the way to and from the wire.

A field is annotated by `Annotated` with its kind: `Scalar`, `Counted`, `Listed` or `Tagged`. A
field whose type is a record needs no kind. Generated messages use only the checks, which raise
EncodeError or DecodeError with the name of the field.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence, Sized
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, TypeAlias, TypeVar

from .message import DecodeError, EncodeError, Message

T = TypeVar("T")
NumberT = TypeVar("NumberT", int, float)

# Part of a step by which a decoded value may miss its integer, by floating point.
_SLACK = 1e-3


def integer(value: NumberT, lower: NumberT, upper: NumberT, field: str) -> NumberT:
    """Returns an integer or real number if it lies in its range."""
    try:
        if lower <= value <= upper:
            return value
    except TypeError:
        raise EncodeError(field, f"{value!r} is not a number") from None
    raise EncodeError(field, f"{value!r} is outside {lower} .. {upper}")


def one_of(value: int, ranges: Sequence[tuple[int, int]], field: str) -> int:
    """Returns an integer if one of the ranges of its value set has it."""
    try:
        if any(lower <= value <= upper for lower, upper in ranges):
            return value
    except TypeError:
        raise EncodeError(field, f"{value!r} is not a number") from None
    raise EncodeError(field, f"{value!r} is not in the value set")


def whole(value: float, lower: int, upper: int, field: str) -> int:
    """Returns a real number without fraction as an integer, if in its range."""
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError):
        raise EncodeError(field, f"{value!r} is not a number") from None
    if number != value:
        raise EncodeError(field, f"{value!r} is not a whole number")
    return integer(number, lower, upper, field)


def whole_of(value: float, ranges: Sequence[tuple[int, int]], field: str) -> int:
    """Returns a real number without fraction as an integer, if in its value set."""
    return one_of(whole(value, ranges[0][0], ranges[-1][1], field), ranges, field)


real = integer


def scaled(value: float, lower: float, step: float, maximum: int, field: str) -> int:
    """Returns the integer nearest to a scaled value (AS5684 scale_range, function round).

    Args:
        lower: Value of the integer 0.
        step: Difference between the values of neighbouring integers.
        maximum: Largest integer.
    """
    try:
        position = (value - lower) / step
        if 0.0 <= position <= maximum:
            return round(position)
    except (TypeError, OverflowError):
        raise EncodeError(field, f"{value!r} is not a number") from None
    return _end(value, lower, step, maximum, field)


def scaled_down(value: float, lower: float, step: float, maximum: int, field: str) -> int:
    """Returns the integer below a scaled value (AS5684 scale_range, function floor)."""
    scaled(value, lower, step, maximum, field)
    return min(max(math.floor((value - lower) / step + _SLACK), 0), maximum)


def scaled_up(value: float, lower: float, step: float, maximum: int, field: str) -> int:
    """Returns the integer above a scaled value (AS5684 scale_range, function ceiling)."""
    scaled(value, lower, step, maximum, field)
    return min(max(math.ceil((value - lower) / step - _SLACK), 0), maximum)


def _end(value: float, lower: float, step: float, maximum: int, field: str) -> int:
    """Returns 0 or the maximum for a value that misses it by floating point only."""
    position = (value - lower) / step
    slack = _SLACK + maximum * 2.0**-50
    if -slack <= position < 0.0:
        return 0
    if maximum < position <= maximum + slack:
        return maximum
    raise EncodeError(field, f"{value!r} is outside {lower} .. {lower + step * maximum}")


def sized(value: Sized, lower: int, upper: int, field: str) -> int:
    """Returns the length of a list or string if it lies in its range."""
    length = len(value)
    if lower <= length <= upper:
        return length
    raise EncodeError(field, f"length {length} is outside {lower} .. {upper}")


def exactly(values: Sequence[T], count: int, field: str) -> Sequence[T]:
    """Returns the elements of an array if they are `count`."""
    sized(values, count, count, field)
    return values


def latin1(value: str, field: str) -> bytes:
    """Returns a string as bytes of Latin-1."""
    try:
        return value.encode("latin-1")
    except UnicodeEncodeError:
        raise EncodeError(field, f"{value!r} has characters beyond Latin-1") from None


def padded(value: str, length: int, field: str) -> bytes:
    """Returns a string as bytes, filled with zeros to a fixed length."""
    text = latin1(value, field)
    sized(text, 0, length, field)
    if b"\0" in text:
        raise EncodeError(field, f"{value!r} has a NUL, which would end it")
    return text.ljust(length, b"\0")


def unpadded(text: bytes) -> str:
    """Returns the string before the first NUL."""
    return text.split(b"\0", 1)[0].decode("latin-1")


def take(buffer: bytes, offset: int, size: int, upper: int, field: str) -> bytes:
    """Returns `size` bytes of the payload from an offset, if at most `upper`."""
    if size > upper:
        raise DecodeError(field, f"length {size} is more than {upper}")
    part = buffer[offset : offset + size]
    if len(part) != size:
        raise DecodeError(field, f"length {size} is more than the {len(part)} bytes that follow")
    return part


def take_text(buffer: bytes, offset: int, size: int, upper: int, field: str) -> str:
    """Returns `size` bytes of the payload as a string, if at most `upper`."""
    return take(buffer, offset, size, upper, field).decode("latin-1")


def check_presence(presence: int, known: int, part: str) -> None:
    """Refuses a presence vector with bits beyond `known`: the size of those fields is unknown."""
    if presence > known:
        raise DecodeError(part, f"unknown bits in presence vector 0x{presence:X}")


def check_count(size: int, upper: int, room: int, element: int, field: str) -> None:
    """Refuses a count of elements that exceeds `upper`, or the bytes left in `room`.

    It is checked before memory is taken; `element` is the least size of an element in bytes.
    """
    if size > upper:
        raise DecodeError(field, f"count {size} is more than {upper}")
    if size * element > room:
        raise DecodeError(field, f"count {size} needs more than the {room} bytes that follow")


ElementT = TypeVar("ElementT")


def greatest(letter: str) -> int:
    """Returns the greatest unsigned integer of a format of `struct`."""
    return (1 << 8 * struct.calcsize(f"<{letter}")) - 1


@dataclass(frozen=True)
class Scalar:
    """A field of a fixed size."""

    format: str  # format for `struct`
    # Returns the number or bytes to pack of a value; takes the attribute for errors, too.
    put: Callable[[Any, str], Any]
    # Returns the value of an unpacked number or bytes; None if they are the value.
    get: Callable[[Any], Any] | None = None
    # Least and greatest value of an integer that is packed unchanged; None for others.
    limits: tuple[int, int] | None = None
    # Whether the bytes can hold integers beyond the limits, which packing would let pass.
    is_narrow: bool = False


def unsigned(size: int, lower: int = 0, upper: int | None = None) -> Scalar:
    """Returns the kind of an unsigned integer of 1, 2, 4 or 8 bytes, within its limits."""
    letter = {1: "B", 2: "H", 4: "I", 8: "Q"}[size]
    maximum = greatest(letter)
    end = maximum if upper is None else upper

    def put(value: int, field: str) -> int:
        return integer(value, lower, end, field)

    is_narrow = (lower, end) != (0, maximum)
    return Scalar(letter, put, limits=(lower, end), is_narrow=is_narrow)


def scaled_unsigned(upper: float) -> Scalar:
    """Returns the kind of a number 0 .. `upper`, scaled to two bytes."""
    step = upper / 0xFFFF
    return Scalar("H", lambda value, field: scaled(value, 0.0, step, 0xFFFF, field), step.__mul__)


def fixed_text(length: int) -> Scalar:
    """Returns the kind of a string of a fixed number of bytes."""
    return Scalar(f"{length}s", lambda value, field: padded(value, length, field), unpadded)


def bits(size: int, bit_field: Any) -> Scalar:
    """Returns the kind of a bit field of 2 or 4 bytes, whose value is an object of a class."""

    def put(value: Any, _: str) -> Any:
        return value.to_integer()

    return Scalar({2: "H", 4: "I"}[size], put, bit_field.from_integer)


@dataclass(frozen=True)
class Counted:
    """The kind of bytes, or a string of Latin-1, behind their count."""

    format: str  # format of the count for `struct`
    least: int = 0  # fewest bytes that may be sent
    is_text: bool = False

    @property
    def most(self) -> int:
        """Most bytes."""
        return greatest(self.format)

    @property
    def take(self) -> Callable[..., Any]:
        """The function that reads the bytes or string from a payload."""
        return take_text if self.is_text else take


@dataclass(frozen=True)
class Listed:
    """The kind of a list of records behind their count."""

    format: str  # format of the count for `struct`

    @property
    def most(self) -> int:
        """Most records."""
        return greatest(self.format)


@dataclass(frozen=True)
class Tagged:
    """The kind of one of several records, behind a byte with its `TAG`."""

    name: str  # name of the field in errors


U8 = Annotated[int, unsigned(1)]
U16 = Annotated[int, unsigned(2)]
U32 = Annotated[int, unsigned(4)]
Text = Annotated[str, Counted("B", is_text=True)]
ShortList = Annotated[list[ElementT], Listed("B")]
LongList = Annotated[list[ElementT], Listed("H")]


@dataclass(slots=True)
class TimeStamp:
    """A time stamp as a bit field of 32 bits (SAE AS5684 bit_field; AS5710, SetTime).

    It has neither month nor year: only a clock can tell them.

    Attributes:
        milliseconds: Milliseconds. 0 .. 999.
        seconds: Seconds. 0 .. 59.
        minutes: Minutes. 0 .. 59.
        hour: Hour. 0 .. 23.
        day: Day of the month. 1 .. 31.
    """

    milliseconds: int = 0
    seconds: int = 0
    minutes: int = 0
    hour: int = 0
    day: int = 1

    def to_integer(self) -> int:
        """Returns the integer that holds the bits."""
        bits = integer(self.milliseconds, 0, 999, "milliseconds")
        bits |= integer(self.seconds, 0, 59, "seconds") << 10
        bits |= integer(self.minutes, 0, 59, "minutes") << 16
        bits |= integer(self.hour, 0, 23, "hour") << 22
        bits |= integer(self.day, 1, 31, "day") << 27
        return bits

    @classmethod
    def of(cls, moment: datetime) -> TimeStamp:
        """Returns the stamp of a moment in UTC, rounded down to milliseconds."""
        return cls(
            moment.microsecond // 1000, moment.second, moment.minute, moment.hour, moment.day
        )

    @classmethod
    def from_integer(cls, bits: int) -> TimeStamp:
        """Returns the stamp of 32 bits, without a check of its parts."""
        return cls(
            bits & 0x3FF, bits >> 10 & 0x3F, bits >> 16 & 0x3F, bits >> 22 & 0x1F, bits >> 27 & 0x1F
        )


class StampedMessage(Message):
    """A message with the time stamp of AS5710, whose class is its attribute `TimeStamp`.

    The alias stands in a base since a dataclass would take an alias in its own body for a field.
    """

    __slots__ = ()

    TimeStamp: TypeAlias = TimeStamp
