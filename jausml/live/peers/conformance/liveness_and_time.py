"""Checks of Liveness, the heartbeat, and of Time, the clock of the target (AS5710A).

The clock is never set.
"""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import check
from jausml.runtime.messages import (
    ConfirmEventRequest,
    Event,
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


@check("liveness.pulse", "Reports its heartbeat", "AS5710A Liveness, QueryHeartbeatPulse")
def pulse(session: Session) -> None:
    """QueryHeartbeatPulse is answered with the empty ReportHeartbeatPulse."""
    session.first.ask(QueryHeartbeatPulse(), ReportHeartbeatPulse)


@check(
    "liveness.event",
    "Reports its heartbeat periodically",
    "AS5710A Liveness, QueryHeartbeatPulse; Events, CreateEvent",
)
def event(session: Session) -> None:
    """A periodic event on the heartbeat is confirmed and delivers it; others watch it so."""
    session.skip_unless(session.serves("Events"), "the target answers nothing of Events")
    answer = session.first.create_event(QueryHeartbeatPulse(), rate=10.0)
    session.require(
        isinstance(answer, ConfirmEventRequest), "a periodic event on the heartbeat is rejected"
    )
    report = session.first.expect(Event, "the event on the heartbeat")
    session.require(
        report.report_message == ReportHeartbeatPulse().encode(),
        f"the event carries {report.report_message.hex()} instead of ReportHeartbeatPulse",
    )


@check("time.report", "Reports time and date", "AS5710A Time, QueryTime, ReportTime")
def report(session: Session) -> None:
    """The fields lie in their ranges; a clock far from ours is noted."""
    answer = session.first.ask(QueryTime(presence_vector=TIME | DATE), ReportTime)
    time, date = answer.time_stamp, answer.date_stamp
    session.require(time is not None, "ReportTime holds no TimeStamp although it was asked for")
    session.require(date is not None, "ReportTime holds no DateStamp although it was asked for")
    if time is None or date is None:
        return
    try:
        theirs = datetime(
            _FIRST_YEAR + date.year,
            date.month,
            date.day,
            time.hour,
            time.minutes,
            time.seconds,
            1000 * time.milliseconds,
            tzinfo=timezone.utc,
        )
    except ValueError as error:
        session.require(holds=False, failure=f"ReportTime holds no date and time: {error}")
        return
    if abs(theirs - datetime.now(timezone.utc)) > _LARGEST_DIFFERENCE:
        session.note(f"its clock says {theirs:%Y-%m-%d %H:%M:%S} UTC, which is not ours")


@check(
    "time.subset",
    "Reports what was asked for",
    "AS5710A Time, QueryTime: PresenceVector; the report may hold more or less",
)
def subset(session: Session) -> None:
    """A query for the time alone and one for the date alone."""
    for vector, name in ((TIME, "TimeStamp"), (DATE, "DateStamp")):
        answer = session.first.ask(QueryTime(presence_vector=vector), ReportTime)
        present = (answer.time_stamp is not None) * TIME | (answer.date_stamp is not None) * DATE
        if present != vector:
            session.note(f"asked for {name} alone, ReportTime has presence vector {present}")


LIVENESS = (pulse, event)
TIME_CHECKS = (report, subset)
