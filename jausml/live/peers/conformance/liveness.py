"""Checks of Liveness: the heartbeat (AS5710A)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import check
from jausml.runtime.messages import (
    ConfirmEventRequest,
    Event,
    QueryHeartbeatPulse,
    ReportHeartbeatPulse,
)

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session


def requires(session: Session) -> str:
    """Returns why the group cannot run, or nothing."""
    return session.missing("Liveness")


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


CHECKS = (pulse, event)
