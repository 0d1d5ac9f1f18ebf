"""Conversions of times."""

from __future__ import annotations

import time
from datetime import date
from functools import lru_cache

from .types import ConversionError, Time, TimeLike, TimeStamp, TimeStampLike

_DAY = 86_400
_DAY_NS = _DAY * 10**9
_EPOCH = date(1970, 1, 1).toordinal()


def timestamp_to_time(stamp: TimeStampLike, *, near: TimeLike) -> Time:
    """A JAUS TimeStamp (day of month, UTC) to the instant nearest to `near`.

    The TimeStamp has neither month nor year. The nearest one is right also for a stamp of the last
    day of a month that arrives on the first day of the next one.

    Raises:
        ConversionError: hour, minutes, seconds or milliseconds are no time of day.
    """
    if not (
        0 <= stamp.hour < 24
        and 0 <= stamp.minutes < 60
        and 0 <= stamp.seconds < 60
        and 0 <= stamp.milliseconds < 1000
    ):
        raise ConversionError("TimeStamp is no time of day")
    seconds = (stamp.hour * 60 + stamp.minutes) * 60 + stamp.seconds
    since_midnight = (seconds * 1000 + stamp.milliseconds) * 10**6
    reference = near.sec * 10**9 + near.nanosec
    first, *others = _days_near(stamp.day, near.sec // _DAY)
    nearest = first * _DAY_NS + since_midnight
    for other in others:
        instant = other * _DAY_NS + since_midnight
        if abs(instant - reference) < abs(nearest - reference):
            nearest = instant
    return Time(*divmod(nearest, 10**9))


def time_to_timestamp(instant: TimeLike) -> TimeStamp:
    """An instant to a JAUS TimeStamp (day of month, UTC), rounded down to milliseconds."""
    utc = time.gmtime(instant.sec)
    milliseconds = instant.nanosec // 1_000_000
    return TimeStamp(milliseconds, utc.tm_sec, utc.tm_min, utc.tm_hour, utc.tm_mday)


@lru_cache(maxsize=64)
def _days_near(day_of_month: int, today: int) -> tuple[int, ...]:
    """Returns the days near `today`, in days since 1970, that are the given day of their month."""
    if not 1 <= day_of_month <= 31:
        # JAUS-DEVIATION: AS6009 has days 1..31, but known peers leave the day at 0. The nearest
        # day serves them better than the loss of every report.
        return today - 1, today, today + 1
    utc = time.gmtime(today * _DAY)
    days = []
    # On 1 March, 31 January is nearer than 31 March, and February has no such day.
    for offset in (-2, -1, 0, 1):
        year, month = divmod(utc.tm_year * 12 + utc.tm_mon - 1 + offset, 12)
        try:
            days.append(date(year, month + 1, day_of_month).toordinal() - _EPOCH)
        except ValueError:  # this month is shorter
            continue
    return tuple(days)
