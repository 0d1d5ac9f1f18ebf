"""Conversions of times, computed here by the calendar of the standard library.

An instant is seconds and nanoseconds since 1970-01-01 UTC; a JAUS TimeStamp is milliseconds,
seconds, minutes, hour and day of the month (AS6009).
"""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

from jausml.language.semantics.conversions.conversion import Conversion, NoValueError
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP

Instant = tuple[int, int]
Stamp = tuple[int, int, int, int, int]

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
# The next day of the same number is at most this far, as from 31 July to 31 May.
_FARTHEST = timedelta(days=62)
_DAY = timedelta(days=1)


class TimestampToTime(Conversion):
    """JAUS TimeStamp (day of month, UTC) to the nearest instant."""

    name = "timestamp_to_time"
    inputs = (TIME_STAMP,)
    outputs = (TIME,)
    inverse = "time_to_timestamp"

    def forward(self, stamp: Stamp, *, near: Instant) -> Instant:
        """The nearest of all instants around with this day and time; any day for day 0."""
        milliseconds, seconds, minutes, hour, day = stamp
        now = _EPOCH + timedelta(seconds=near[0])
        try:
            found = now.replace(
                hour=hour, minute=minutes, second=seconds, microsecond=milliseconds * 1000
            )
        except ValueError as error:
            raise NoValueError(self.name) from error
        days = range(-_FARTHEST.days, _FARTHEST.days + 1)
        instants = [
            _instant(found + number * _DAY) for number in days if _is_day(found, number, day)
        ]
        return min(instants, key=lambda each: abs(_nanoseconds(each) - _nanoseconds(near)))


class TimeToTimestamp(Conversion):
    """An instant to a JAUS TimeStamp (day of month, UTC)."""

    name = "time_to_timestamp"
    inputs = (TIME,)
    outputs = (TIME_STAMP,)
    inverse = "timestamp_to_time"

    def forward(self, instant: Instant) -> Stamp:
        """Day and time of the calendar."""
        found = _EPOCH + timedelta(seconds=instant[0])
        return instant[1] // 10**6, found.second, found.minute, found.hour, found.day


def _is_day(first: datetime, number: int, day: int) -> bool:
    return not 1 <= day <= 31 or (first + number * _DAY).day == day


def _instant(moment: datetime) -> Instant:
    since = moment - _EPOCH
    return since // timedelta(seconds=1), since.microseconds * 1000


def _nanoseconds(instant: Instant) -> int:
    return instant[0] * 10**9 + instant[1]


CONVERSIONS = (TimestampToTime(), TimeToTimestamp())
