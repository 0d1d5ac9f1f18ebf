"""Checks of Liveness, the heartbeat, and of Time, the clock of the target (AS5710A).

The clock is never set.
"""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import Check
from jausml.live.peers.conformance.event_steps import carries, created
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.conformance.steps import A, AnythingBut, ask, serves, usual
from jausml.runtime.messages import (
    QueryHeartbeatPulse,
    QueryTime,
    ReportHeartbeatPulse,
    ReportTime,
)

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session

TIME, DATE = 1, 2
"""Bits of the presence vector of QueryTime and ReportTime (AS5710A)."""

_FIRST_YEAR = 2000
_LARGEST_DIFFERENCE = timedelta(seconds=5)


def _is_a_time(session: Session, found: ReportTime, what: str) -> None:
    """The fields lie in their ranges; a clock far from ours is noted."""
    time, date = found.time_stamp, found.date_stamp
    if time is None or date is None:
        lacking = "TimeStamp" if time is None else "DateStamp"
        raise CheckFailed(f"{what} holds no {lacking} although it was asked for")
    day = (_FIRST_YEAR + date.year, date.month, date.day)
    clock = (time.hour, time.minutes, time.seconds, 1000 * time.milliseconds)
    try:
        theirs = datetime(*day, *clock, tzinfo=timezone.utc)
    except ValueError as error:
        raise CheckFailed(f"{what} holds no date and time: {error}") from error
    if abs(theirs - session.probe.utc()) > _LARGEST_DIFFERENCE:
        session.note(f"its clock says {theirs:%Y-%m-%d %H:%M:%S} UTC, which is not ours")


LIVENESS = (
    Check(
        "liveness.pulse",
        "Reports its heartbeat",
        "AS5710A Liveness, QueryHeartbeatPulse",
        "QueryHeartbeatPulse is answered with the empty ReportHeartbeatPulse.",
        (ask(A, QueryHeartbeatPulse(), ReportHeartbeatPulse),),
    ),
    Check(
        "liveness.event",
        "Reports its heartbeat periodically",
        "AS5710A Liveness, QueryHeartbeatPulse; Events, CreateEvent",
        "A periodic event on the heartbeat is confirmed and delivers it; others watch it so.",
        (
            serves("Events"),
            created(A, query=QueryHeartbeatPulse()),
            carries(A, ReportHeartbeatPulse),
        ),
    ),
)
TIME_CHECKS = (
    Check(
        "time.report",
        "Reports time and date",
        "AS5710A Time, QueryTime, ReportTime",
        "The fields lie in their ranges; a clock far from ours is noted.",
        (ask(A, QueryTime(presence_vector=TIME | DATE), ReportTime, _is_a_time),),
    ),
    Check(
        "time.subset",
        "Reports what was asked for",
        "AS5710A Time, QueryTime: PresenceVector; the report may hold more or less",
        "A query for the time alone and one for the date alone.",
        (
            ask(
                A,
                QueryTime(presence_vector=TIME),
                ReportTime,
                usual(time_stamp=AnythingBut(None), date_stamp=None),
            ),
            ask(
                A,
                QueryTime(presence_vector=DATE),
                ReportTime,
                usual(time_stamp=None, date_stamp=AnythingBut(None)),
            ),
        ),
    ),
)
