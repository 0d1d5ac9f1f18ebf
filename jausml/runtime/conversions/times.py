"""Conversions of times."""

from __future__ import annotations

import time
from datetime import date
from typing import TYPE_CHECKING

from .types import ConversionError, Time, TimeStamp

if TYPE_CHECKING:
    from .types import TimeLike, TimeStampLike

__all__ = [
    "time_to_timestamp",
    "timestamp_to_time",
]

_DAY_NS = 86_400 * 10**9
_EPOCH = date(1970, 1, 1).toordinal()


def timestamp_to_time(stamp: TimeStampLike, *, near: TimeLike) -> Time:
    """A JAUS TimeStamp (day of month, UTC) to the instant nearest to `near`.

    The TimeStamp names neither month nor year. Only a clock tells them, and only nearness makes a
    stamp from just before midnight of the last of the month right when it arrives on the first.

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
    minutes = stamp.hour * 60 + stamp.minutes
    of_day = ((minutes * 60 + stamp.seconds) * 1000 + stamp.milliseconds) * 10**6
    reference = near.sec * 10**9 + near.nanosec
    instants = [day * _DAY_NS + of_day for day in _days_near(stamp.day, near.sec)]
    return Time(*divmod(min(instants, key=lambda instant: abs(instant - reference)), 10**9))


def time_to_timestamp(instant: TimeLike) -> TimeStamp:
    """An instant to a JAUS TimeStamp (day of month, UTC); parts of a millisecond are cut off."""
    utc = time.gmtime(instant.sec)
    milliseconds = instant.nanosec // 1_000_000
    return TimeStamp(milliseconds, utc.tm_sec, utc.tm_min, utc.tm_hour, utc.tm_mday)


def _days_near(day_of_month: int, seconds: int) -> list[int]:
    """Days since 1970 around an instant that are the given day of their month."""
    utc = time.gmtime(seconds)
    if not 1 <= day_of_month <= 31:
        # JAUS-DEVIATION: AS6009 has days 1..31, but known peers leave the day at 0. The nearest
        # day serves them better than the loss of every report.
        today = date(utc.tm_year, utc.tm_mon, utc.tm_mday).toordinal() - _EPOCH
        return [today - 1, today, today + 1]
    days = []
    for offset in (-1, 0, 1):
        year, month = divmod(utc.tm_year * 12 + utc.tm_mon - 1 + offset, 12)
        try:
            days.append(date(year, month + 1, day_of_month).toordinal() - _EPOCH)
        except ValueError:  # this month is shorter
            continue
    return days
