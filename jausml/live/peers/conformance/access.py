"""Checks of AccessControl: who controls the target (AS5710A, protocol behaviour)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import Check, check, step
from jausml.live.peers.conformance.session import NOBODY, Authority
from jausml.live.peers.conformance.steps import (
    A,
    B,
    needs,
    rejected,
    send,
    take,
)
from jausml.live.peers.discovery import controller_of
from jausml.runtime import messages as core
from jausml.runtime.messages import (
    ConfirmControl,
    QueryAuthority,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportAuthority,
    ReportTimeout,
    RequestControl,
    SetAuthority,
)
from jausml.runtime.services.definitions import Status

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.wire.message import Message

ACCEPTED = ConfirmControl.ResponseCode.CONTROL_ACCEPTED
INSUFFICIENT = ConfirmControl.ResponseCode.INSUFFICIENT_AUTHORITY
BELOW, LOW, MIDDLE, HIGH = Authority

_EARLIEST = 0.8
_LATEST = 1.5
"""Parts of the announced timeout between which control must lapse."""


def requires(session: Session) -> str:
    """Returns why the group cannot run, or nothing."""
    missing = session.missing("AccessControl")
    if missing:
        return missing
    if not session.tells_controller:
        return _why_no_control(session)
    report = session.control()
    if controller_of(report) != NOBODY:
        return (
            f"{controller_of(report)} controls the target with authority {report.authority_code}; "
            "release it first"
        )
    if session.provides("Management"):
        status = session.status()
        if status not in (Status.STANDBY, Status.READY):
            return f"the target is in {status.name}, where control is not available"
    return ""


def _why_no_control(session: Session) -> str:
    """Returns why control cannot be had, found out by asking for it."""
    session.first.send(RequestControl(authority_code=session.authority(LOW)))
    answer = session.first.expect(ConfirmControl, "RequestControl")
    if answer.response_code == ACCEPTED:
        return ""
    return (
        f"the target gives no control (ConfirmControl {answer.response_code}), and does not answer "
        "QueryControl, which would say who has it"
    )


def timeout_in_reach(session: Session) -> int:
    """Returns the announced timeout in seconds, when the run may wait for it."""
    seconds = session.first.ask(QueryTimeout(), core.ReportTimeout).timeout
    session.skip_unless(seconds > 0, "the target announces that control never lapses")
    session.skip_unless(
        session.limits.slow or seconds <= session.limits.longest_wait,
        f"the announced timeout of {seconds} s is long; --slow waits for it",
    )
    return seconds


@step
def request(
    session: Session,
    client: int,
    level: Authority,
    expected: ConfirmControl.ResponseCode | None = None,
) -> None:
    """A client asks for control and is answered with a code, if one is expected."""
    authority = session.authority(level)
    session.send(client, RequestControl(authority_code=authority))
    if expected is None:
        return
    what = f"{session.latest} with authority {authority}"
    code = session.client(client).expect(ConfirmControl, what).response_code
    session.require(
        code == expected,
        f"{what} is answered with ConfirmControl {code} instead of "
        f"{int(expected)} ({expected.name})",
    )


@step
def set_authority(session: Session, client: int, level: Authority) -> None:
    """A client sets its authority."""
    session.send(client, SetAuthority(authority_code=session.authority(level)))


@step
def unanswered(session: Session, client: int, kind: type[Message]) -> None:
    """A client without control should get no such message; one is noted."""
    if session.client(client).find(kind, within=session.probe.quiet) is not None:
        session.note(f"{session.latest}, which has no control, is answered")


@step
def controlled_by(session: Session, client: int, level: Authority) -> None:
    """ReportControl names a client and its authority."""
    report, address = session.seen_control(), str(session.client(client).address)
    if report is None:
        return
    session.require(
        controller_of(report) == address,
        f"ReportControl names {controller_of(report)} instead of {address}",
    )
    session.require(
        report.authority_code == session.authority(level),
        f"ReportControl says authority {report.authority_code} "
        f"instead of {session.authority(level)}",
    )


@step
def kept(session: Session, client: int, level: Authority) -> None:
    """A client is not told that it lost control, and has it still."""
    keeper = session.client(client)
    keeper.expect_none(RejectControl, f"{session.latest} takes no control from {keeper.address}")
    controlled_by(client, level)(session)


@step
def uncontrolled(session: Session) -> None:
    """ReportControl names nobody and the default authority."""
    report = session.seen_control()
    if report is None:
        return
    session.require(
        controller_of(report) == NOBODY,
        f"ReportControl still names {controller_of(report)}",
    )
    session.require(
        report.authority_code == session.default_authority,
        f"ReportControl says authority {report.authority_code} without a controller instead of "
        f"the default {session.default_authority}",
    )


@check(
    "access.uncontrolled",
    "Reports no controller and its default authority",
    "AS5710A AccessControl, NotControlled (entry), QueryControl, QueryAuthority",
)
def uncontrolled_at_first(session: Session) -> None:
    """Without a controller, ReportControl names 0.0.0 with the default authority.

    ReportAuthority must name the same authority.
    """
    report = session.control()
    session.require(
        controller_of(report) == NOBODY,
        f"ReportControl names {controller_of(report)} although nobody has control",
    )
    authority = session.first.ask(QueryAuthority(), ReportAuthority).authority_code
    session.require(
        authority == report.authority_code,
        f"ReportControl says authority {report.authority_code}, ReportAuthority {authority}",
    )


@check(
    "access.timeout-reported",
    "Reports its control timeout",
    "AS5710A AccessControl, QueryTimeout",
)
def timeout_reported(session: Session) -> None:
    """QueryTimeout is answered with the seconds after which control lapses; 0 means never."""
    report = session.first.ask(QueryTimeout(), ReportTimeout)
    session.trace.remark(f"control lapses after {report.timeout} s (0: never)")


@check(
    "access.release-uncontrolled",
    "Answers ReleaseControl when nobody has control",
    "AS5710A AccessControl, NotControlled: ReleaseControl",
)
def release_uncontrolled(session: Session) -> None:
    """ReleaseControl is answered with RejectControl 0 even without control."""
    send(A, ReleaseControl())(session)
    if session.is_v1_0("AccessControl"):
        if session.first.find(RejectControl) is None:
            session.note("not answered; AS5710 before revision A leaves that open")
        return
    rejected(A)(session)


@check(
    "access.timeout",
    "Takes control back from a silent controller after the announced timeout",
    "AS5710A AccessControl, Controlled: Timedout; ReportTimeout",
)
def timeout(session: Session) -> None:
    """RejectControl 0 comes between 0.8 and 1.5 of the announced timeout, and not before."""
    seconds = timeout_in_reach(session)
    take(A, LOW)(session)
    early = session.first.find(RejectControl, within=seconds * _EARLIEST)
    session.require(early is None, f"control lapsed before the announced {seconds} s")
    late = session.first.find(RejectControl, within=seconds * (_LATEST - _EARLIEST) + 0.5)
    session.require(late is not None, f"control did not lapse after the announced {seconds} s")
    uncontrolled()(session)


@check(
    "access.timeout-renewed",
    "Counts the timeout anew when its controller asks again",
    "AS5710A AccessControl, Controlled: RequestControl of the controller restarts the timer",
)
def timeout_renewed(session: Session) -> None:
    """A controller that asks again within the timeout keeps control past its first end."""
    seconds = timeout_in_reach(session)
    take(A, LOW)(session)
    lost = session.first.find(RejectControl, within=seconds * 0.6)
    session.require(lost is None, f"control lapsed before the announced {seconds} s")
    request(A, LOW, ACCEPTED)(session)
    lost = session.first.find(RejectControl, within=seconds * 0.7)
    session.require(lost is None, "control lapsed although it was asked for again in time")


CHECKS = (
    uncontrolled_at_first,
    timeout_reported,
    Check(
        "access.request",
        "Gives control to the first who asks",
        "AS5710A AccessControl, NotControlled: RequestControl",
        "RequestControl with sufficient authority is confirmed with 0.\n\n"
        "ReportControl then names the client and its authority.",
        (request(A, LOW, ACCEPTED), controlled_by(A, LOW)),
    ),
    Check(
        "access.insufficient",
        "Refuses an authority below its default",
        "AS5710A AccessControl, NotControlled: RequestControl, default authority > requested",
        "RequestControl below the default authority is answered with 2 and changes nothing.",
        (request(A, BELOW, INSUFFICIENT), uncontrolled()),
    ),
    Check(
        "access.keep-alive",
        "Confirms its controller again and takes its new authority",
        "AS5710A AccessControl, Controlled: RequestControl of the controller",
        "A controller that asks again is confirmed with 0; its authority becomes the new one.",
        (
            take(A, LOW),
            request(A, HIGH, ACCEPTED),
            controlled_by(A, HIGH),
            request(A, LOW, ACCEPTED),
            controlled_by(A, LOW),
        ),
    ),
    Check(
        "access.controller-below-default",
        "Drops a controller that asks with less than the default authority",
        "AS5710A AccessControl, Controlled: RequestControl of the controller, default > requested",
        "The controller is told RejectControl 0, and nobody has control.",
        (needs(BELOW), take(A, LOW), request(A, BELOW), rejected(A), uncontrolled()),
    ),
    Check(
        "access.preemption",
        "Lets a higher authority take control",
        "AS5710A AccessControl, Controlled: RequestControl of another, current < requested",
        "The new controller is confirmed with 0; the old one is told RejectControl 0.",
        (take(A, LOW), request(B, HIGH, ACCEPTED), rejected(A), controlled_by(B, HIGH)),
    ),
    Check(
        "access.equal-authority",
        "Does not let the same authority take control",
        "AS5710A AccessControl, Controlled: RequestControl of another, current >= requested",
        "The second client is answered with 2; the first one keeps control.",
        (take(A, MIDDLE), request(B, MIDDLE, INSUFFICIENT), kept(A, MIDDLE)),
    ),
    Check(
        "access.lower-authority",
        "Does not let a lower authority take control",
        "AS5710A AccessControl, Controlled: RequestControl of another, current >= requested",
        "The second client is answered with 2; the first one keeps control.",
        (take(A, HIGH), request(B, LOW, INSUFFICIENT), kept(A, HIGH)),
    ),
    Check(
        "access.set-authority",
        "Lets its controller lower its authority",
        "AS5710A AccessControl, Controlled: SetAuthority, default <= new <= current",
        "ReportAuthority then says the new one, and a client between the two may take control.",
        (take(A, HIGH), set_authority(A, LOW), controlled_by(A, LOW), request(B, MIDDLE, ACCEPTED)),
    ),
    Check(
        "access.set-authority-raised",
        "Does not let its controller raise its authority by SetAuthority",
        "AS5710A AccessControl, Controlled: SetAuthority, guard new <= current",
        "SetAuthority above the present authority has no effect.",
        (take(A, LOW), set_authority(A, HIGH), controlled_by(A, LOW)),
    ),
    Check(
        "access.set-authority-below-default",
        "Does not let its controller fall below the default authority",
        "AS5710A AccessControl, Controlled: SetAuthority, guard default <= new",
        "SetAuthority below the default authority has no effect.",
        (needs(BELOW), take(A, LOW), set_authority(A, BELOW), controlled_by(A, LOW)),
    ),
    Check(
        "access.set-authority-by-other",
        "Ignores SetAuthority of others than its controller",
        "AS5710A AccessControl, Controlled: SetAuthority, guard on the sender",
        "SetAuthority of a client without control has no effect.",
        (take(A, HIGH), set_authority(B, LOW), controlled_by(A, HIGH)),
    ),
    Check(
        "access.release",
        "Lets its controller release control",
        "AS5710A AccessControl, Controlled: ReleaseControl of the controller",
        "ReleaseControl is answered with RejectControl 0, and nobody has control.",
        (take(A, LOW), send(A, ReleaseControl()), rejected(A), uncontrolled()),
    ),
    release_uncontrolled,
    Check(
        "access.release-by-other",
        "Ignores ReleaseControl of others than its controller",
        "AS5710A AccessControl, Controlled: ReleaseControl, guard on the sender",
        "ReleaseControl of a client without control is not answered and has no effect.",
        (take(A, LOW), send(B, ReleaseControl()), unanswered(B, RejectControl), kept(A, LOW)),
    ),
    Check(
        "access.release-after-preemption",
        "Ignores ReleaseControl of its former controller",
        "AS5710A AccessControl, Controlled: ReleaseControl, guard on the sender",
        "A client that was preempted cannot release the control of its successor.",
        (take(A, LOW), take(B, HIGH), send(A, ReleaseControl()), kept(B, HIGH)),
    ),
    timeout,
    timeout_renewed,
)
