"""Conversions of times.

An instant is seconds and nanoseconds since 1970-01-01 UTC; a JAUS TimeStamp is milliseconds,
seconds, minutes, hour and day of the month (AS6009).
"""

from __future__ import annotations

from jausml.language.semantics.conversions.conversion import Conversion
from jausml.language.semantics.conversions.definition import Definition
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP

# Years begin in March here, so that the leap day is the last of a year; months count from that of
# the year 0. An era is 400 years, 146097 days (Hinnant, chrono-compatible date algorithms).
_MONTH_OF_TODAY = """
        era = floor((today + 719468) / 146097)
        of_era = today + 719468 - 146097 * era
        leaps = floor(of_era / 1460) - floor(of_era / 36524) + floor(of_era / 146096)
        year = floor((of_era - leaps) / 365)
        of_year = of_era - (365 * year + floor(year / 4) - floor(year / 100))
        of_months = floor((5 * of_year + 2) / 153)
        month = 12 * (400 * era + year) + of_months
        """


def _first_of(name: str, month: str) -> str:
    """The day that is the first of a month, since 1970."""
    return f"""
        {name}_month = {month}
        {name}_year = floor({name}_month / 12)
        {name}_leaps = floor({name}_year / 4) - floor({name}_year / 100) + floor({name}_year / 400)
        {name}_days = floor((153 * ({name}_month - 12 * {name}_year) + 2) / 5)
        {name} = 365 * {name}_year + {name}_leaps + {name}_days - 719468
        """


def _on(name: str, following: str, without_day: str) -> str:
    """The second of a stamp in a month, and how many nanoseconds it is away; infinite for none."""
    return f"""
        {name}_is_day = not has_day or day <= {following} - {name}
        {name}_at = if(has_day, {name} + day - 1, {without_day}) * 86400 + of_day
        {name}_apart = ({name}_at - near_sec) * 1000000000 + milliseconds * 1000000 - near_nanosec
        {name}_away = if({name}_is_day, abs({name}_apart), inf)
        """


class TimestampToTime(Conversion):
    """JAUS TimeStamp (day of month, UTC) to the nearest instant."""

    name = "timestamp_to_time"
    inputs = (TIME_STAMP,)
    outputs = (TIME,)
    inverse = "time_to_timestamp"
    definition = Definition(
        "milliseconds, seconds, minutes, hour, day, near_sec, near_nanosec",
        "today = floor(near_sec / 86400)"
        + _MONTH_OF_TODAY
        + _first_of("earliest", "month - 2")
        + _first_of("earlier", "month - 1")
        + _first_of("current", "month")
        + _first_of("later", "month + 1")
        + _first_of("last", "month + 2")
        + """
        has_day = day >= 1 and day <= 31
        of_day = hour * 3600 + minutes * 60 + seconds
        """
        + _on("earliest", "earlier", "today - 1")
        + _on("earlier", "current", "today - 1")
        + _on("current", "later", "today")
        + _on("later", "last", "today + 1")
        + """
        is_earlier = earlier_away <= current_away and earlier_away <= later_away
        next_at = if(current_away <= later_away, current_at, later_at)
        nearest_at = if(is_earlier, earlier_at, next_at)
        nearest_away = min(earlier_away, current_away, later_away)
        if(earliest_away <= nearest_away, earliest_at, nearest_at)
        milliseconds * 1000000
        """,
        refused="""not (hour >= 0 and hour < 24 and minutes >= 0 and minutes < 60
            and seconds >= 0 and seconds < 60 and milliseconds >= 0 and milliseconds < 1000)""",
        reason="TimeStamp is no time of day",
    )


class TimeToTimestamp(Conversion):
    """An instant to a JAUS TimeStamp (day of month, UTC)."""

    name = "time_to_timestamp"
    inputs = (TIME,)
    outputs = (TIME_STAMP,)
    inverse = "timestamp_to_time"
    definition = Definition(
        "sec, nanosec",
        "today = floor(sec / 86400)"
        + _MONTH_OF_TODAY
        + """
        of_day = sec - 86400 * today
        floor(nanosec / 1000000)
        of_day - 60 * floor(of_day / 60)
        floor(of_day / 60) - 60 * floor(of_day / 3600)
        floor(of_day / 3600)
        of_year - floor((153 * of_months + 2) / 5) + 1
        """,
    )
