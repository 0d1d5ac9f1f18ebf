"""Shaping: which messages of a connection pass, by their number, their pace and their age.

Messages come to it before they are passed on, and only where there is something to shape, or the
process stood still.
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
Drop = Callable[[str, str], None]


OVER_RATE = "over_rate"  # messages of a source that sends more than its connection takes
_BURST_S = 1.0
_MOST_SOURCES = 256
_EVERYBODY_ELSE = "everybody else"


class RateCap:
    """Lets pass so many messages a second of each source, and a second's worth of them at once.

    What a source has sent is one number: the time until which it would have taken at the rate of
    the cap. Beyond a certain number of sources the others have one allowance together, so that
    many names are worth no more than one, and need no memory. It stands before the translation, as
    a source that sends far more than it should would make the others wait.
    """

    def __init__(
        self, hertz: float, clock: Callable[[], float], drop: Callable[[str, str], None]
    ) -> None:
        self._interval = 1 / hertz
        # Half an interval of tolerance: clocks round.
        self._ahead = max(_BURST_S - self._interval, 0.0) + self._interval / 2
        self._clock = clock
        self._drop = drop
        self._until: dict[Any, float] = {}
        self._looked = clock()

    def before(self, way: Take) -> Take:
        """Returns what takes messages instead of a way, and gives it those that pass."""
        clock, drop, until = self._clock, self._drop, self._until
        interval, ahead = self._interval, self._ahead

        def take(data: bytes, sender: Any) -> None:
            now = clock()
            # A known source costs one look-up.
            name = sender if sender in until else self._name(sender, now)
            taken = until.get(name, now)
            if taken - now > ahead:
                drop(OVER_RATE, str(name))
                return
            until[name] = max(taken, now) + interval
            way(data, sender)

        return take

    def _name(self, sender: Any, now: float) -> Any:
        """Returns under which name a new source has its allowance."""
        until = self._until
        # Once a second at most: a flood of names must not cost a search each.
        if len(until) >= _MOST_SOURCES and now - self._looked >= _BURST_S:
            self._looked = now
            for name in [name for name, time in until.items() if time <= now]:
                del until[name]
        return sender if len(until) < _MOST_SOURCES else _EVERYBODY_ELSE


@dataclass(frozen=True, slots=True)
class Shape:
    """What shall pass."""

    max_rate: float = 0.0  # most messages each second; 0 means all
    decimation: int = 1  # every how many messages one passes
    age_limit: float = 0.0  # seconds after which a message is too old; 0 means never

    @property
    def is_plain(self) -> bool:
        """Whether all messages pass when they come."""
        return not (self.max_rate > 0 or self.decimation > 1 or self.age_limit > 0)

    @property
    def interval(self) -> float:
        """Least seconds from one message to the next."""
        return 1 / self.max_rate if self.max_rate > 0 else 0.0


class Waiting(NamedTuple):
    """A message whose time has not come."""

    data: bytes
    origin: Any
    expiry: float  # when it becomes too old, by the clock of the bridge


class Shaping:
    """Lets pass what shall, in order, the newest at last.

    All of it runs on the loop, or with its lock.
    """

    def __init__(self, shape: Shape, counts: Statistics, drop: Drop) -> None:
        self._shape = shape
        self._counts = counts
        self._drop = drop
        self._ends: Ends
        self._age: Age
        self._way: Take
        self._reshaped: Callable[[], None]
        self._judge_silence: Callable[[], None]
        self._skipped = 0
        self._is_usable = False
        self._passed = -math.inf
        self._waiting: Waiting | None = None
        self._timer: Alarm

    def open(
        self,
        name: str,
        ends: Ends,
        age: Age,
        way: Take,
        reshaped: Callable[[], None],
        judge_silence: Callable[[], None],
    ) -> None:
        """Reads what parameters say, and tells when other messages shall pass than before."""
        self._ends, self._age, self._way, self._reshaped = ends, age, way, reshaped
        self._judge_silence = judge_silence
        self._timer = Alarm(ends.clock)
        self._skipped, self._is_usable, self._passed = 0, False, -math.inf
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
            # It may be due now, or later than before.
            if self._waiting is not None:
                self._arrange()
            self._reshaped()

    # ------------------------------------------------------------------ messages

    @property
    def is_plain(self) -> bool:
        """Whether there is nothing to shape."""
        return self._shape.is_plain

    def withdraw(self) -> Waiting | None:
        """Begins anew; returns what waited and passes no more."""
        self._skipped = 0
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            self._timer.cancel()
        return waiting

    def thin(self) -> None:
        """Counts a message that gives way to others."""
        self._counts.arrivals += 1
        self._counts.thinned += 1

    def take(self, data: bytes, origin: Any) -> None:
        """Takes a message, which passes now, later, or not at all."""
        now = self._ends.clock.now()
        # 0 after a stop, so that the first message then passes.
        if 0 < self._skipped < self._shape.decimation:
            self._skipped += 1
            self._note(now)
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
            self._note(now)
        elif now < self._due:
            self._waiting = Waiting(data, origin, expiry)
            self._note(now)
            self._arrange()
        else:
            self._pass(data, origin, now)

    @property
    def _due(self) -> float:
        return self._passed + self._shape.interval

    def _arrange(self) -> None:
        """Has what waits pass when its time has come, or now."""
        self._timer.cancel()
        if self._ends.clock.now() < self._due:
            self._timer.set_at(self._due, self._arrange)
            return
        self._judge_silence()
        # The stop of a silent source may have withdrawn it just now.
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            now = self._ends.clock.now()
            if waiting.expiry < now:
                self._refuse(now, now - waiting.expiry)
            else:
                self._pass(waiting.data, waiting.origin, now)

    def _pass(self, data: bytes, origin: Any, now: float) -> None:
        self._passed = now
        self._way(data, origin)
        # What could not be translated was not heard: the source said nothing usable.
        self._is_usable = self._counts.heard >= now

    def _expiry(self, data: bytes, origin: Any, now: float) -> float:
        if self._shape.age_limit <= 0:
            return math.inf
        return now + self._shape.age_limit - (self._age(data, origin) or 0.0)

    def _refuse(self, now: float, excess: float) -> None:
        """Counts a message that is too old; the source has said nothing that could be used."""
        self._counts.arrivals += 1
        self._counts.last_arrival = now
        self._is_usable = False
        age = self._shape.age_limit + excess
        self._drop(TOO_OLD, f"{age:.3f} s old, the limit is {self._shape.age_limit:g} s")

    def _note(self, now: float) -> None:
        """Notes that the source lives, if the last message that passed said something usable."""
        self._counts.last_arrival = now
        if self._is_usable:
            self._counts.heard = now


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
