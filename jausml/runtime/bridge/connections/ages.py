"""Ages of messages: what is too old, and commands that waited while the process stood still."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import Any

from ...base.loop import Timer
from ...base.standstill import Watch
from ...conversions import ConversionError, Time, timestamp_to_time
from ...wire.message import DecodeError, Message
from ..ends.ends import Ends
from ..ends.ros_side import RosSide
from ..light_message import is_light
from ..messages import cdr
from ..reports.diagnostics import TOO_OLD, Age, Statistics

Drop = Callable[[str, str], None]

_STAMPS = {cdr.LITTLE: struct.Struct("<iI"), cdr.BIG: struct.Struct(">iI")}
_STAMPED = {("header", "std_msgs/Header"), ("stamp", "builtin_interfaces/Time")}
_NANO = 10**9


def ros_age(ros_type: type[Any], ros: RosSide, wall: Callable[[], int]) -> Age:
    """Returns what tells the age of messages of a ROS type.

    That is the one of its stamp by the ROS clock; of a type or message without one, that of its
    publication, which the publisher tells by the clock of its computer.
    """
    is_stamped = _begins_with_stamp(ros_type)

    def age(data: bytes, origin: int) -> float | None:
        # It stands at the begin of the bytes, so nothing has to be decoded for it.
        stamp = _first_stamp(data) if is_stamped else 0
        if stamp:
            return (_nanoseconds(ros.now()) - stamp) / _NANO
        return (wall() - origin) / _NANO if origin else None

    return age


def jaus_age(message_type: type[Message], clock: Callable[[], Time]) -> Age:
    """Returns what tells the age of a JAUS message by its TimeStamp and a clock."""

    def age(data: bytes, _origin: object) -> float | None:
        try:
            stamp = getattr(message_type.decode(data), "time_stamp", None)
            if stamp is None:
                return None
            now = clock()
            sent = timestamp_to_time(stamp, near=now)
        except (DecodeError, ConversionError):
            return None  # whoever translates the message says what is wrong with it
        return (_nanoseconds(now) - _nanoseconds(sent)) / _NANO

    return age


def _begins_with_stamp(ros_type: type[Any]) -> bool:
    if is_light(ros_type):
        layout: Mapping[str, str] = ros_type.LAYOUT
    else:
        layout = ros_type.get_fields_and_field_types()
    return next(iter(layout.items()), None) in _STAMPED


def _first_stamp(data: bytes) -> int:
    """Returns the stamp that a message begins with in nanoseconds, 0 if nobody filled it."""
    order = cdr.ORDERS.get(data[:2])
    if order is None or len(data) < len(cdr.HEADER) + 8:
        return 0
    seconds, nanoseconds = _STAMPS[order].unpack_from(data, len(cdr.HEADER))
    return int(seconds) * _NANO + int(nanoseconds)


def _nanoseconds(moment: Time) -> int:
    return moment.sec * _NANO + moment.nanosec


_REPEATED = 5.0
"""Seconds after a standstill in which the middleware of ROS may still bring what was sent before.

It repeats what a reader has missed when the writer tells of it, which Fast DDS does each 3 s.
"""


class Backlog:
    """Tells after a standstill which commands of a connection are of long ago.

    A time-out of silence says how long a command may stand. One that waited longer, before anybody
    could notice the silence, counts no more either. Where nothing says when a message was sent,
    all that waited is refused: the next one is on its way.
    """

    def __init__(
        self, counts: Statistics, drop: Drop, waited: Callable[[Any], float | None]
    ) -> None:
        """Refuses nothing before `open`; None has waited where nobody knows when it was sent."""
        self._counts, self._drop, self._waited = counts, drop, waited
        self._ends: Ends
        self._changed: Callable[[], None]
        self._watch: Watch | None = None
        self._end: Timer | None = None
        self._limit = self._still = 0.0
        self._has_caught_up = True

    @property
    def is_there(self) -> bool:
        """Whether a message may have waited."""
        return self._end is not None

    def open(self, ends: Ends, limit: float, changed: Callable[[], None]) -> None:
        """Begins to look for standstills.

        Args:
            limit: Seconds that a command may have waited; 0 for any time.
            changed: Called when there is a backlog, before any of it is taken, and when there is
                none any more.
        """
        self._ends, self._changed, self._limit = ends, changed, limit
        self._watch = ends.loop.standstill.watch(limit, self._stood_still, self._caught_up)

    def close(self) -> None:
        """Looks no more."""
        if self._watch is not None:
            self._watch.cancel()
        self._finish()

    def change(self, limit: float) -> None:
        """Lets commands have waited for another time from now on."""
        self._limit = limit
        if self._watch is not None:
            self._watch.change(limit)

    def admits(self, origin: Any) -> bool:
        """Returns whether a message is young enough; it is counted if it is not."""
        waited = self._waited(origin)
        # Of unknown age, while what waited is served: it may be as old as the standstill.
        if waited is None and not self._has_caught_up:
            waited = self._still
        if waited is None or self._limit <= 0 or waited <= self._limit:
            return True
        # Refused before the way on which arrivals are counted.
        self._counts.arrivals += 1
        self._counts.last_arrival = self._ends.clock.now()
        self._drop(TOO_OLD, f"it waited up to {waited:.2f} s while the process stood still")
        return False

    def _stood_still(self, seconds: float) -> None:
        # A further standstill begins the time anew.
        self._finish()
        self._still, self._has_caught_up = seconds, False
        self._end = self._ends.loop.call_later(_REPEATED, self._over)
        self._changed()

    def _caught_up(self) -> None:
        self._has_caught_up = True

    def _over(self) -> None:
        self._finish()
        self._changed()

    def _finish(self) -> None:
        if self._end is not None:
            self._end.cancel()
            self._end = None
