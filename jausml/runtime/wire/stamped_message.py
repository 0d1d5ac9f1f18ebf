"""Base of the generated messages that hold a time stamp."""

from __future__ import annotations

from typing import TypeAlias

from .message import Message
from .time_stamp import TimeStamp as JausTimeStamp


class StampedMessage(Message):
    """A message with the time stamp of AS5710, whose class it offers as `TimeStamp`.

    The class stands here since a dataclass would take an alias in its own body for a field.
    """

    __slots__ = ()

    TimeStamp: TypeAlias = JausTimeStamp
