"""The time stamp of messages, and the base of the generated messages that hold one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from .codec import integer
from .message import Message

if TYPE_CHECKING:
    from datetime import datetime


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
        """Returns what the bits of an integer say, legal or not.

        Args:
            bits: The integer, 0 .. 2**32 - 1.
        """
        return cls(
            bits & 0x3FF,
            bits >> 10 & 0x3F,
            bits >> 16 & 0x3F,
            bits >> 22 & 0x1F,
            bits >> 27 & 0x1F,
        )


class StampedMessage(Message):
    """A message with the time stamp of AS5710, whose class it offers as `TimeStamp`.

    The class stands here since a dataclass would take an alias in its own body for a field.
    """

    __slots__ = ()

    TimeStamp: TypeAlias = TimeStamp
