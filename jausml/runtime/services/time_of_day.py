"""The Time service: a clock that the controller may set (AS5710)."""

from __future__ import annotations

from datetime import datetime, time, timezone

from ..base.address import JausAddress
from ..base.counters import LOGGER
from ..messages import QueryTime, ReportTime, SetTime
from .definitions import CORE, Guard
from .host import Host

TIME_STAMP = 1 << 0  # bit of time and day of month in the PresenceVector of a QueryTime
DATE_STAMP = 1 << 1  # bit of the date there
FIRST_YEAR = 2000  # year 0 of a DateStamp


class TimeService:
    """Reports the time in UTC; SetTime sets its offset to the clock of the host."""

    urns = frozenset([CORE + "Time"])

    def __init__(self, component: Host) -> None:
        self._component = component

    def attach(self) -> None:
        """Takes the messages of Time."""
        self._component.handle(SetTime, self._set_time, when=Guard.CONTROLLED)
        # Time changes continuously, so that only periodic events are useful.
        self._component.provide(QueryTime, ReportTime, self._report, every_change=False)

    def _set_time(self, message: SetTime, sender: JausAddress) -> None:
        try:
            stated_time = self._time_of(message)
        except (ValueError, OverflowError) as error:
            self._component.counters.count("time.refused", f"SetTime of {sender}: {error}")
            return
        self._component.time_offset = stated_time - self._component.host_time()
        LOGGER.info("%s: time set by %s", self._component.address, sender)
        self._component.call(self._component.on_set_time, stated_time)

    def _time_of(self, message: SetTime) -> datetime:
        """Returns the time of a SetTime, completed by the present date; raises ValueError."""
        now = self._component.current_time
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
        now = self._component.current_time
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
    """Returns the time nearest to now with a day of month and time of day.

    A TimeStamp has no month: near the end of a month its day may be one of the next.
    """
    candidates = []
    for months in (-2, -1, 0, 1):
        year, month = divmod(now.year * 12 + now.month - 1 + months, 12)
        try:
            candidates.append(_moment(year, month + 1, day, clock))
        except ValueError:
            continue  # the month has no such day
    if not candidates:
        raise ValueError(f"no month near {now:%Y-%m} has a day {day}")
    return min(candidates, key=lambda moment: abs(moment - now))
