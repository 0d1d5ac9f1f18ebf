"""The Liveness and Time services: a heartbeat, and a clock that the controller may set (AS5710)."""

from __future__ import annotations

from datetime import datetime, time, timedelta, timezone
from typing import TYPE_CHECKING

from ..base.address import BROADCAST, WILDCARD_COMPONENT, WILDCARD_NODE, JausAddress
from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..messages import QueryHeartbeatPulse, QueryTime, ReportHeartbeatPulse, ReportTime, SetTime
from .definitions import CORE, Guard, Scope

if TYPE_CHECKING:
    from ..wire.message import Message
    from .host import Host

UNSOLICITED = "urn:jaus:jss:iop:UnsolicitedHeartbeat"
"""Service of the IOP that promises an unrequested heartbeat."""

UNSOLICITED_RATE = 1.0
"""Rate in Hz of a component that provides it; the IOP leaves the rate open."""


class LivenessService:
    """Answers QueryHeartbeatPulse, and sends its report unasked if that is wanted."""

    urns = frozenset([CORE + "Liveness", CORE + "Liveliness"])  # v1.0 spells it both ways

    def __init__(self, component: Host) -> None:
        """Learn from settings and services of the component what it sends unasked."""
        self._component = component
        self._timer = Alarm(component.loop)
        settings, own = component.settings, component.address
        unsolicited = any(service.urn == UNSOLICITED for service in component.services)
        default = UNSOLICITED_RATE if unsolicited else 0.0
        self._rate = default if settings.heartbeat_rate is None else settings.heartbeat_rate
        subsystem = JausAddress(own.subsystem, WILDCARD_NODE, WILDCARD_COMPONENT)
        self._audience = BROADCAST if settings.heartbeat_scope is Scope.SYSTEM else subsystem
        self._speaks_first = False

    def attach(self) -> None:
        """Take the messages of Liveness."""
        # The search for a Discovery server is heard as well.
        self._speaks_first = not self._component.settings.register_services
        self._component.provide(QueryHeartbeatPulse, ReportHeartbeatPulse, _pulse)

    def start(self) -> None:
        """Begin to send unrequested heartbeats if any are wanted, or at least be heard once.

        Peers learn where a component is from what it sends, and some never forget where it was
        (Junior): one that starts again elsewhere and says nothing would not be found.
        """
        if self._rate > 0:
            self._beat()
        elif self._speaks_first:
            self._component.send(ReportHeartbeatPulse(), BROADCAST)

    def stop(self) -> None:
        """Send no heartbeat any more."""
        self._timer.cancel()

    def _beat(self) -> None:
        self._timer.set(1.0 / self._rate, self._beat)
        self._component.send(ReportHeartbeatPulse(), self._audience)


def _pulse(_query: Message, _sender: JausAddress) -> ReportHeartbeatPulse:
    return ReportHeartbeatPulse()


TIME_STAMP = 1 << 0
"""Bit of the time of day and day of month in a QueryTime's PresenceVector."""

DATE_STAMP = 1 << 1
"""Bit of the date in a QueryTime's PresenceVector."""

FIRST_YEAR = 2000
"""Year that a DateStamp counts from."""


class TimeService:
    """Reports the time in UTC, and keeps the offset to the host's clock that SetTime asks for.

    The clock of the host is never set.
    """

    urns = frozenset([CORE + "Time"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._offset = timedelta()

    def attach(self) -> None:
        """Take the messages of Time."""
        self._component.handle(SetTime, self._set_time, when=Guard.CONTROLLED)
        # Time changes always: only a rate makes sense.
        self._component.provide(QueryTime, ReportTime, self._report, every_change=False)

    def now(self) -> datetime:
        """Return the component's time in UTC."""
        return self._component.host_time() + self._offset

    def _set_time(self, message: SetTime, sender: JausAddress) -> None:
        try:
            stated_time = self._time_meant(message)
        except (ValueError, OverflowError) as error:
            self._component.counters.count("time.refused", f"SetTime of {sender}: {error}")
            return
        self._offset = stated_time - self._component.host_time()
        LOGGER.info("%s: time set by %s", self._component.address, sender)
        self._component.call(self._component.on_set_time, stated_time)

    def _time_meant(self, message: SetTime) -> datetime:
        """Return the moment that a SetTime means; raises ValueError when it means none."""
        now = self.now()
        stamp, date = message.time_stamp, message.date_stamp
        if stamp is None and date is None:
            raise ValueError("it holds neither a time nor a date")
        if stamp is None:
            clock = now.time()
        else:
            clock = time(stamp.hour, stamp.minutes, stamp.seconds, stamp.milliseconds * 1000)
        if date is None:
            return _nearest(now, stamp.day if stamp is not None else now.day, clock)
        if stamp is not None and stamp.day != date.day:
            raise ValueError(f"its days contradict each other: {stamp.day} and {date.day}")
        return _moment(FIRST_YEAR + date.year, date.month, date.day, clock)

    def _report(self, query: QueryTime, _sender: JausAddress) -> ReportTime:
        now = self.now()
        report = ReportTime()
        if query.presence_vector & TIME_STAMP:
            report.time_stamp = ReportTime.TimeStamp.of(now)
        if query.presence_vector & DATE_STAMP:
            report.date_stamp = ReportTime.DateStamp(
                day=now.day, month=now.month, year=now.year - FIRST_YEAR
            )
        return report


def _moment(year: int, month: int, day: int, clock: time) -> datetime:
    return datetime(
        year,
        month,
        day,
        clock.hour,
        clock.minute,
        clock.second,
        clock.microsecond,
        tzinfo=timezone.utc,
    )


def _nearest(now: datetime, day: int, clock: time) -> datetime:
    """Return the moment nearest to now that has the day of month and time of day.

    A TimeStamp has no month: near the end of one, its day may be of the next.
    """
    candidates = []
    for months in (-1, 0, 1):
        year, month = divmod(now.year * 12 + now.month - 1 + months, 12)
        try:
            candidates.append(_moment(year, month + 1, day, clock))
        except ValueError:
            continue  # the month has no such day
    if not candidates:
        raise ValueError(f"no month near {now:%Y-%m} has a day {day}")
    return min(candidates, key=lambda moment: abs(moment - now))
