"""Time stamps of JAUS as the integers of their bits, for translations from bytes to bytes.

The bits are those of `wire.time_stamp.TimeStamp`: 10 of milliseconds, 6 of seconds, 6 of minutes,
5 of the hour and 5 of the day of the month.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .times import day_of_month, instant_near

if TYPE_CHECKING:
    from .types import Time, TimeLike

NO_STAMP = -1
"""What is no time stamp: no integer of bits is negative."""


def time_of(bits: int, near: TimeLike) -> Time:
    """The bits of a JAUS TimeStamp to the instant nearest to `near`, as `timestamp_to_time`.

    Raises:
        ConversionError: hour, minutes, seconds or milliseconds are no time of day.
    """
    return instant_near(
        bits >> 27 & 0x1F,
        bits >> 22 & 0x1F,
        bits >> 16 & 0x3F,
        bits >> 10 & 0x3F,
        bits & 0x3FF,
        near,
    )


def bits_of(sec: int, nanosec: int) -> int:
    """An instant to the bits of a JAUS TimeStamp, as `time_to_timestamp`.

    Args:
        sec: Seconds since 1970-01-01 UTC.
        nanosec: Nanoseconds within the second; more than a second has no time stamp.

    Returns:
        The bits, or NO_STAMP.
    """
    if nanosec >= 1_000_000_000:
        return NO_STAMP
    days, of_day = divmod(sec, 86_400)
    minutes, seconds = divmod(of_day, 60)
    hour, minute = divmod(minutes, 60)
    day = day_of_month(days)
    return day << 27 | hour << 22 | minute << 16 | seconds << 10 | nanosec // 1_000_000
