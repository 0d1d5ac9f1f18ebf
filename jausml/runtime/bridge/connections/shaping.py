"""Shaping: which messages of a connection pass, by their number, rate and age.

`RateCap` limits each source, `Shaping` applies the limits of the model, and `Backlog` refuses
commands that waited while the process stood still. All are asked before a message is translated.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from ...base.clocks import Alarm
from ...base.loop import Timer
from ...base.standstill import Watch
from ...conversions import ConversionError, Time, timestamp_to_time
from ...wire.message import DecodeError, Message
from ..ends import parameters
from ..ends.ends import Ends
from ..ends.ros_side import RosSide
from ..light_message import is_light
from ..messages import cdr
from ..reports.diagnostics import TOO_OLD, Age, Statistics

Take = Callable[[bytes, Any], None]
Drop = Callable[[str, str], None]  # counts a message that is dropped: reason and detail

OVER_RATE = "over_rate"  # reason of messages beyond the rate cap of their source
_BURST_S = 1.0
_MAX_SOURCES = 256
_EVERYBODY_ELSE = "everybody else"


class RateCap:
    """Limits the messages each second of each source, with bursts of one second's worth.

    For each source it keeps one number: the time at which the messages so far would end if they
    came at the rate of the cap. Sources beyond `_MAX_SOURCES` share one allowance, so that many
    names gain nothing and need no memory. It acts before the translation, since the translations
    for one source that sends far too much would delay all others.
    """

    def __init__(
        self, hertz: float, clock: Callable[[], float], drop: Callable[[str, str], None]
    ) -> None:
        self._interval = 1 / hertz
        # Half an interval of tolerance: clocks round.
        self._ahead = max(_BURST_S - self._interval, 0.0) + self._interval / 2
        self._clock = clock
        self._drop = drop
        self._ends: dict[Any, float] = {}  # of the allowance that each source has used
        self._last_cleanup = clock()

    def before(self, take: Take) -> Take:
        """Returns a function that drops messages over the cap, and calls `take` with the others."""
        clock, drop, ends = self._clock, self._drop, self._ends
        interval, ahead = self._interval, self._ahead

        def take_capped(data: bytes, sender: Any) -> None:
            now = clock()
            # A known source costs one look-up.
            name = sender if sender in ends else self._allowance(sender, now)
            end = ends.get(name, now)
            if end - now > ahead:
                drop(OVER_RATE, str(name))
                return
            ends[name] = max(end, now) + interval
            take(data, sender)

        return take_capped

    def _allowance(self, sender: Any, now: float) -> Any:
        """Returns the name of the allowance of a new source: its own, or that of the rest."""
        ends = self._ends
        # Once a second at most: a flood of names must not cost a search each.
        if len(ends) >= _MAX_SOURCES and now - self._last_cleanup >= _BURST_S:
            self._last_cleanup = now
            for name in [name for name, end in ends.items() if end <= now]:
                del ends[name]
        return sender if len(ends) < _MAX_SOURCES else _EVERYBODY_ELSE


@dataclass(frozen=True, slots=True)
class Shape:
    """Limits on the messages that pass."""

    max_rate: float = 0.0  # most messages each second; 0 means all
    decimation: int = 1  # of so many messages one passes
    age_limit: float = 0.0  # seconds after which a message is too old; 0 means never

    @property
    def is_plain(self) -> bool:
        """Whether all messages pass at once."""
        return not (self.max_rate > 0 or self.decimation > 1 or self.age_limit > 0)

    @property
    def interval(self) -> float:
        """Least seconds between two messages."""
        return 1 / self.max_rate if self.max_rate > 0 else 0.0


class Waiting(NamedTuple):
    """A message that waits for the end of the interval."""

    data: bytes
    origin: Any
    expiry: float  # time at which it becomes too old, by the clock of the bridge


class Shaping:
    """Passes messages within the limits of a shape, in order; of those that wait, the newest.

    Everything runs on the loop, or with its lock.
    """

    def __init__(self, shape: Shape, counts: Statistics, drop: Drop) -> None:
        self._shape = shape
        self._counts = counts
        self._drop = drop
        self._ends: Ends
        self._age: Age
        self._pass_on: Take
        self._reshaped: Callable[[], None]
        self._judge_silence: Callable[[], None]
        self._skipped = 0
        self._is_usable = False
        self._last_pass = -math.inf
        self._waiting: Waiting | None = None
        self._timer: Alarm

    def open(
        self,
        name: str,
        ends: Ends,
        age: Age,
        pass_on: Take,
        reshaped: Callable[[], None],
        judge_silence: Callable[[], None],
    ) -> None:
        """Declares the parameters of the connection `name` and reads their values.

        Args:
            pass_on: Called with each message that passes.
            reshaped: Called when a parameter has changed the shape.
            judge_silence: Called before a message that waited passes, to stop a silent source.
        """
        self._ends, self._age, self._pass_on, self._reshaped = ends, age, pass_on, reshaped
        self._judge_silence = judge_silence
        self._timer = Alarm(ends.clock)
        self._skipped, self._is_usable, self._last_pass = 0, False, -math.inf
        shape, declare = self._shape, ends.ros.parameter
        self._shape = Shape(
            declare(parameters.MAX_RATE.of(shape.max_rate, name), self._setting("max_rate")),
            declare(parameters.DECIMATION.of(shape.decimation, name), self._setting("decimation")),
            declare(parameters.AGE_LIMIT.of(shape.age_limit, name), self._setting("age_limit")),
        )

    def _setting(self, name: str) -> Callable[[Any], None]:
        return lambda value: self._change(replace(self._shape, **{name: value}))

    def _change(self, shape: Shape) -> None:
        with self._ends.loop.lock:
            self._shape = shape
            # The message may be due now, or later than before.
            if self._waiting is not None:
                self._pass_when_due()
            self._reshaped()

    # ------------------------------------------------------------------ messages

    @property
    def is_plain(self) -> bool:
        """Whether all messages pass at once."""
        return self._shape.is_plain

    def withdraw(self) -> Waiting | None:
        """Begins anew; returns the message that waited, which will not pass."""
        self._skipped = 0
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            self._timer.cancel()
        return waiting

    def thin(self) -> None:
        """Counts a message that is left out in favour of others."""
        self._counts.arrivals += 1
        self._counts.thinned += 1

    def take(self, data: bytes, origin: Any) -> None:
        """Takes a message, which passes now, later, or not at all."""
        now = self._ends.clock.now()
        # 0 after a stop, so that the first message then passes.
        if 0 < self._skipped < self._shape.decimation:
            self._skipped += 1
            self._mark_alive(now)
            self.thin()
            return
        self._skipped = 1
        expiry = self._expiry(data, origin, now)
        if expiry < now:
            self._refuse(now, now - expiry)
            return
        if self._waiting is not None:
            # The newest takes the place of the one that waits; the time stays.
            self.thin()
            self._waiting = Waiting(data, origin, expiry)
            self._mark_alive(now)
        elif now < self._due:
            self._waiting = Waiting(data, origin, expiry)
            self._mark_alive(now)
            self._pass_when_due()
        else:
            self._pass(data, origin, now)

    @property
    def _due(self) -> float:
        return self._last_pass + self._shape.interval

    def _pass_when_due(self) -> None:
        """Passes the message that waits, now or by a timer when it is due."""
        self._timer.cancel()
        if self._ends.clock.now() < self._due:
            self._timer.set_at(self._due, self._pass_when_due)
            return
        self._judge_silence()
        # The stop of a silent source may have withdrawn the message just now.
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            now = self._ends.clock.now()
            if waiting.expiry < now:
                self._refuse(now, now - waiting.expiry)
            else:
                self._pass(waiting.data, waiting.origin, now)

    def _pass(self, data: bytes, origin: Any, now: float) -> None:
        self._last_pass = now
        self._pass_on(data, origin)
        # A message that could not be translated does not count as heard.
        self._is_usable = self._counts.heard >= now

    def _expiry(self, data: bytes, origin: Any, now: float) -> float:
        if self._shape.age_limit <= 0:
            return math.inf
        return now + self._shape.age_limit - (self._age(data, origin) or 0.0)

    def _refuse(self, now: float, excess: float) -> None:
        """Counts a message that is too old, and by which the source does not count as heard."""
        self._counts.arrivals += 1
        self._counts.last_arrival = now
        self._is_usable = False
        age = self._shape.age_limit + excess
        self._drop(TOO_OLD, f"{age:.3f} s old, the limit is {self._shape.age_limit:g} s")

    def _mark_alive(self, now: float) -> None:
        """Counts the source as heard, if its last message that passed could be translated."""
        self._counts.last_arrival = now
        if self._is_usable:
            self._counts.heard = now


_STAMPS = {cdr.LITTLE: struct.Struct("<iI"), cdr.BIG: struct.Struct(">iI")}
_STAMPED = {("header", "std_msgs/Header"), ("stamp", "builtin_interfaces/Time")}
_NANO = 10**9


def ros_age(ros_type: type[Any], ros: RosSide, wall: Callable[[], int]) -> Age:
    """Returns the function for the age of messages of a ROS type.

    The age is that of the stamp by the ROS clock; without a stamp, that of the publication, which
    `wall` compares with the clock of the publisher's computer.
    """
    is_stamped = _begins_with_stamp(ros_type)

    def age(data: bytes, origin: int) -> float | None:
        # The stamp is at the begin of the bytes, so the message need not be decoded.
        stamp = _first_stamp(data) if is_stamped else 0
        if stamp:
            return (_nanoseconds(ros.now()) - stamp) / _NANO
        return (wall() - origin) / _NANO if origin else None

    return age


def jaus_age(message_type: type[Message], clock: Callable[[], Time]) -> Age:
    """Returns the function for the age of JAUS messages by their TimeStamp and a clock."""

    def age(data: bytes, _origin: object) -> float | None:
        try:
            stamp = getattr(message_type.decode(data), "time_stamp", None)
            if stamp is None:
                return None
            now = clock()
            sent = timestamp_to_time(stamp, near=now)
        except (DecodeError, ConversionError):
            return None  # the translation reports the error
        return (_nanoseconds(now) - _nanoseconds(sent)) / _NANO

    return age


def _begins_with_stamp(ros_type: type[Any]) -> bool:
    if is_light(ros_type):
        layout: Mapping[str, str] = ros_type.LAYOUT
    else:
        layout = ros_type.get_fields_and_field_types()
    return next(iter(layout.items()), None) in _STAMPED


def _first_stamp(data: bytes) -> int:
    """Returns the stamp at the begin of a message in nanoseconds; 0 if it was not filled."""
    order = cdr.ORDERS.get(data[:2])
    if order is None or len(data) < len(cdr.HEADER) + 8:
        return 0
    seconds, nanoseconds = _STAMPS[order].unpack_from(data, len(cdr.HEADER))
    return int(seconds) * _NANO + int(nanoseconds)


def _nanoseconds(moment: Time) -> int:
    return moment.sec * _NANO + moment.nanosec


# Seconds after a standstill in which the middleware of ROS may still deliver older messages. It
# repeats messages that a reader has missed at the heartbeat of the writer: with Fast DDS, each 3 s.
_REPETITION_S = 5.0


class Backlog:
    """Refuses commands that are too old after the process stood still.

    The time-out of silence limits how long a command may be in effect, so a command that waited
    longer during the standstill is refused too. Where the time of sending is unknown, every command
    that waited is refused: the source will soon send the next one.
    """

    def __init__(
        self, counts: Statistics, drop: Drop, seconds_waited: Callable[[Any], float | None]
    ) -> None:
        """Refuses no command before `open`.

        Args:
            seconds_waited: Returns the seconds since a message was sent, by its origin; None if
                they are unknown.
        """
        self._counts, self._drop, self._seconds_waited = counts, drop, seconds_waited
        self._ends: Ends
        self._changed: Callable[[], None]
        self._watch: Watch | None = None
        self._end: Timer | None = None
        self._limit = self._standstill = 0.0
        self._has_caught_up = True

    @property
    def is_active(self) -> bool:
        """Whether messages that waited during a standstill may still come."""
        return self._end is not None

    def open(self, ends: Ends, limit: float, changed: Callable[[], None]) -> None:
        """Begins to look for standstills.

        Args:
            limit: Longest seconds that a command may have waited; 0 for any time.
            changed: Called at the begin of a backlog, before its first message, and at its end.
        """
        self._ends, self._changed, self._limit = ends, changed, limit
        self._watch = ends.loop.standstill.watch(limit, self._stood_still, self._caught_up)

    def close(self) -> None:
        """Ends the backlog, and the watch for standstills."""
        if self._watch is not None:
            self._watch.cancel()
        self._finish()

    def change(self, limit: float) -> None:
        """Changes the longest seconds that a command may have waited."""
        self._limit = limit
        if self._watch is not None:
            self._watch.change(limit)

    def admits(self, origin: Any) -> bool:
        """Returns whether a message is young enough; drops and counts it otherwise."""
        waited = self._seconds_waited(origin)
        # A message of unknown age that waited may be as old as the standstill.
        if waited is None and not self._has_caught_up:
            waited = self._standstill
        if waited is None or self._limit <= 0 or waited <= self._limit:
            return True
        # `Connection.pass_on`, which counts arrivals, does not see this one.
        self._counts.arrivals += 1
        self._counts.last_arrival = self._ends.clock.now()
        self._drop(TOO_OLD, f"it waited up to {waited:.2f} s while the process stood still")
        return False

    def _stood_still(self, seconds: float) -> None:
        # A further standstill begins the time anew.
        self._finish()
        self._standstill, self._has_caught_up = seconds, False
        self._end = self._ends.loop.call_later(_REPETITION_S, self._finish_backlog)
        self._changed()

    def _caught_up(self) -> None:
        self._has_caught_up = True

    def _finish_backlog(self) -> None:
        self._finish()
        self._changed()

    def _finish(self) -> None:
        if self._end is not None:
            self._end.cancel()
            self._end = None
