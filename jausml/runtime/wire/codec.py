"""Kinds of fields, and what they check of values on their way to and from the wire.

The annotation of a field is `Annotated` with its kind: a `Scalar`, or what is `Counted`, `Listed`
or `Tagged`. A field whose type is a record needs no kind. Generated messages make the checks alone.
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

# Part of a step by which floating point may miss an integer that was decoded before.
_SLACK = 1e-3


def integer(value: NumberT, lower: NumberT, upper: NumberT, field: str) -> NumberT:
    """Returns an integer, or a real number, that lies in its range."""
    try:
        if lower <= value <= upper:
            return value
    except TypeError:
        raise EncodeError(field, f"{value!r} is not a number") from None
    raise EncodeError(field, f"{value!r} is outside {lower} .. {upper}")


def one_of(value: int, ranges: Sequence[tuple[int, int]], field: str) -> int:
    """Returns an integer that its value set lists."""
    try:
        if any(lower <= value <= upper for lower, upper in ranges):
            return value
    except TypeError:
        raise EncodeError(field, f"{value!r} is not a number") from None
    raise EncodeError(field, f"{value!r} is not in the value set")


def whole(value: float, lower: int, upper: int, field: str) -> int:
    """Returns the integer that a real number stands for."""
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError):
        raise EncodeError(field, f"{value!r} is not a number") from None
    if number != value:
        raise EncodeError(field, f"{value!r} is not a whole number")
    return integer(number, lower, upper, field)


def whole_of(value: float, ranges: Sequence[tuple[int, int]], field: str) -> int:
    """Returns the integer of a value set that a real number stands for."""
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
    """Returns the end that a value misses by no more than floating point does, or raises."""
    position = (value - lower) / step
    slack = _SLACK + maximum * 2.0**-50
    if -slack <= position < 0.0:
        return 0
    if maximum < position <= maximum + slack:
        return maximum
    raise EncodeError(field, f"{value!r} is outside {lower} .. {lower + step * maximum}")


def sized(value: Sized, lower: int, upper: int, field: str) -> int:
    """Returns the length of a list or string that is neither too short nor too long."""
    length = len(value)
    if lower <= length <= upper:
        return length
    raise EncodeError(field, f"length {length} is outside {lower} .. {upper}")


def exactly(values: Sequence[T], count: int, field: str) -> Sequence[T]:
    """Returns the elements of an array, which has a fixed number of them."""
    sized(values, count, count, field)
    return values


def latin1(value: str, field: str) -> bytes:
    """Returns a string as bytes, one for each character."""
    try:
        return value.encode("latin-1")
    except UnicodeEncodeError:
        raise EncodeError(field, f"{value!r} has characters beyond Latin-1") from None


def padded(value: str, length: int, field: str) -> bytes:
    """Returns a string of fixed length as bytes with zeros; EncodeError where it does not fit."""
    text = latin1(value, field)
    sized(text, 0, length, field)
    if b"\0" in text:
        raise EncodeError(field, f"{value!r} has a NUL, which would end it")
    return text.ljust(length, b"\0")


def unpadded(text: bytes) -> str:
    """Returns the string that fixed bytes hold: what stands before the first NUL."""
    return text.split(b"\0", 1)[0].decode("latin-1")


def take(buffer: bytes, offset: int, size: int, upper: int, field: str) -> bytes:
    """Returns a counted part of the payload."""
    if size > upper:
        raise DecodeError(field, f"length {size} is more than {upper}")
    part = buffer[offset : offset + size]
    if len(part) != size:
        raise DecodeError(field, f"length {size} is more than the {len(part)} bytes that follow")
    return part


def take_text(buffer: bytes, offset: int, size: int, upper: int, field: str) -> str:
    """Returns a counted string of the payload."""
    return take(buffer, offset, size, upper, field).decode("latin-1")


def check_presence(presence: int, known: int, part: str) -> None:
    """Refuses a presence vector with bits of unknown fields, whose size nobody knows."""
    if presence > known:
        raise DecodeError(part, f"unknown bits in presence vector 0x{presence:X}")


def check_count(size: int, upper: int, room: int, element: int, field: str) -> None:
    """Checks a count, by the fewest bytes of an element, before memory is taken."""
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

    format: str  # its format for `struct`
    # Returns what is packed of a value; it is also given the attribute that an error names.
    put: Callable[[Any, str], Any]
    # Returns the value of what was unpacked; None for that itself.
    get: Callable[[Any], Any] | None = None
    # Least and greatest value of an integer that is packed as it is; None for others.
    limits: tuple[int, int] | None = None
    # Whether its bytes can hold more than these, which packing does not find.
    is_narrow: bool = False


def unsigned(size: int, lower: int = 0, upper: int | None = None) -> Scalar:
    """Returns the kind of an integer of some bytes, 1, 2, 4 or 8, which fills them by default."""
    letter = {1: "B", 2: "H", 4: "I", 8: "Q"}[size]
    most = greatest(letter)
    end = most if upper is None else upper

    def put(value: int, field: str) -> int:
        return integer(value, lower, end, field)

    is_narrow = (lower, end) != (0, most)
    return Scalar(letter, put, limits=(lower, end), is_narrow=is_narrow)


def scaled_unsigned(upper: float) -> Scalar:
    """Returns the kind of a number from 0, as a scaled integer of two bytes."""
    step = upper / 0xFFFF
    return Scalar("H", lambda value, field: scaled(value, 0.0, step, 0xFFFF, field), step.__mul__)


def fixed_text(length: int) -> Scalar:
    """Returns the kind of a string of a fixed number of bytes."""
    return Scalar(f"{length}s", lambda value, field: padded(value, length, field), unpadded)


def bits(size: int, bit_field: Any) -> Scalar:
    """Returns the kind of a bit field of some bytes, 2 or 4, which has a class."""

    def put(value: Any, _: str) -> Any:
        return value.to_integer()

    return Scalar({2: "H", 4: "I"}[size], put, bit_field.from_integer)


@dataclass(frozen=True)
class Counted:
    """Bytes, or a string of Latin-1, behind their number."""

    format: str  # format of the number for `struct`
    least: int = 0  # fewest bytes that may be sent
    is_text: bool = False

    @property
    def most(self) -> int:
        """Most bytes."""
        return greatest(self.format)

    @property
    def take(self) -> Callable[..., Any]:
        """What takes them, as the type of the field."""
        return take_text if self.is_text else take


@dataclass(frozen=True)
class Listed:
    """Records behind their number, which has a format for `struct`."""

    format: str

    @property
    def most(self) -> int:
        """Most records."""
        return greatest(self.format)


@dataclass(frozen=True)
class Tagged:
    """One of several records, behind a byte that says which one: its `TAG`."""

    name: str  # what an error calls the field


U8 = Annotated[int, unsigned(1)]
U16 = Annotated[int, unsigned(2)]
U32 = Annotated[int, unsigned(4)]
Text = Annotated[str, Counted("B", is_text=True)]
ShortList = Annotated[list[ElementT], Listed("B")]
LongList = Annotated[list[ElementT], Listed("H")]


@dataclass(slots=True)
class TimeStamp:
    """A time stamp as a bit field of 32 bits (SAE AS5684 bit_field; AS5710, SetTime).

    Neither month nor year is named: only a clock tells which day of that number is meant.

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
        """Returns the stamp of a moment in UTC; parts of a millisecond are cut off."""
        return cls(
            moment.microsecond // 1000, moment.second, moment.minute, moment.hour, moment.day
        )

    @classmethod
    def from_integer(cls, bits: int) -> TimeStamp:
        """Returns what the 32 bits of an integer say, legal or not."""
        return cls(
            bits & 0x3FF, bits >> 10 & 0x3F, bits >> 16 & 0x3F, bits >> 22 & 0x1F, bits >> 27 & 0x1F
        )


class StampedMessage(Message):
    """A message with the time stamp of AS5710, whose class it offers as `TimeStamp`.

    The class stands here since a dataclass would take an alias in its own body for a field.
    """

    __slots__ = ()

    TimeStamp: TypeAlias = TimeStamp
