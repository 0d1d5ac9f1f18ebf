"""Checks of AccessControl: who controls the target (AS5710A, protocol behaviour)."""

from __future__ import annotations

from collections.abc import Callable

from jausml.live.peers.conformance.check import Check, Step, step
from jausml.live.peers.conformance.session import INSUFFICIENT, NOBODY, Authority, Session
from jausml.live.peers.conformance.steps import (
    A,
    B,
    ask,
    expect,
    expect_none,
    has,
    needs,
    send,
    take,
)
from jausml.live.peers.discovery import controller_of
from jausml.runtime.messages import (
    ConfirmControl,
    QueryControl,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportControl,
    ReportTimeout,
    RequestControl,
    SetAuthority,
)
from jausml.runtime.services.definitions import Status

ACCEPTED = ConfirmControl.ResponseCode.CONTROL_ACCEPTED
BELOW, LOW, MIDDLE, HIGH = Authority


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
    authority = session.authority(LOW)
    session.first.send(RequestControl(authority_code=authority))
    answer = session.first.expect(ConfirmControl, "RequestControl")
    if answer.response_code == ACCEPTED:
        return ""
    reason = f"ConfirmControl {answer.response_code}"
    if answer.response_code == INSUFFICIENT:
        reason = f"insufficient authority, even with {authority}: {reason}"
    return (
        f"the target gives no control ({reason}), and does not answer QueryControl, which says "
        "who has it"
    )


def control_timeout(session: Session) -> int:
    """Returns the seconds after which control lapses, as the target announces them."""
    return session.first.ask(QueryTimeout(), ReportTimeout).timeout


@step
def timeout_in_reach(session: Session) -> None:
    """Skips the check unless the run may wait for the announced timeout."""
    seconds = control_timeout(session)
    session.skip_unless(seconds > 0, "the target announces that control never lapses")
    session.skip_unless(
        session.limits.slow or seconds <= session.limits.longest_wait,
        f"the announced timeout of {seconds} s is long; --slow waits for it",
    )


@step
def holds(session: Session, client: int, part: float) -> None:
    """A client has control for a part of the announced timeout."""
    seconds = part * control_timeout(session)
    lost = session.client(client).find(RejectControl, within=seconds)
    session.require(lost is None, f"control lapsed before {seconds:g} s of the timeout were over")


@step
def lapses(session: Session, client: int, part: float) -> None:
    """A client is told that control lapsed, within a part of the timeout and half a second."""
    seconds = part * control_timeout(session) + 0.5
    session.client(client).expect(RejectControl, f"the timeout and {seconds:g} s", within=seconds)


@step
def request(
    session: Session,
    client: int,
    level: Authority,
    expected: ConfirmControl.ResponseCode | None = None,
) -> None:
    """A client asks for control and is answered with a code, if one is expected."""
    session.send(client, RequestControl(authority_code=session.authority(level)))
    if expected is not None:
        expect(client, ConfirmControl, has(response_code=expected))(session)


def rejected(client: int, code: int = 0, *, unless: Callable[[Session], str] | None = None) -> Step:
    """A client is told that it has no control, with a code."""
    return expect(client, RejectControl, has(response_code=code), unless=unless)


@step
def set_authority(session: Session, client: int, level: Authority) -> None:
    """A client sets its authority."""
    session.send(client, SetAuthority(authority_code=session.authority(level)))


@step
def controlled_by(session: Session, client: int, level: Authority) -> None:
    """ReportControl names a client and its authority."""
    _require_control(session, str(session.client(client).address), session.authority(level))


@step
def kept(session: Session, client: int, level: Authority) -> None:
    """A client is not told that it lost control, and has it still."""
    expect_none(client, RejectControl, f"{session.latest} takes no control")(session)
    controlled_by(client, level)(session)


@step
def uncontrolled(session: Session) -> None:
    """ReportControl names nobody and the default authority."""
    _require_control(session, NOBODY, session.default_authority)


@step
def nobody_controls(session: Session) -> None:
    """ReportControl names nobody, with any authority."""
    _require_control(session, NOBODY)


def _require_control(session: Session, address: str, authority: int | None = None) -> None:
    report = session.seen_control()
    if report is None:
        return
    controller = controller_of(report)
    session.require(
        controller == address,
        f"ReportControl names {controller} instead of {address} after {session.latest}",
    )
    session.require(
        authority in (None, report.authority_code),
        f"ReportControl says authority {report.authority_code} instead of {authority}",
    )


def _left_open_in_1_0(session: Session) -> str:
    old = session.is_v1_0("AccessControl")
    return "not answered; AS5710 before revision A leaves that open" if old else ""


CHECKS = (
    Check(
        "access.uncontrolled",
        "Reports no controller and its default authority",
        "AS5710A AccessControl, NotControlled (entry), QueryControl, QueryAuthority",
        "Without a controller, ReportControl names 0.0.0 with the default authority.\n\n"
        "ReportAuthority must name the same authority.",
        (ask(A, QueryControl(), ReportControl), uncontrolled()),
    ),
    Check(
        "access.timeout-reported",
        "Reports its control timeout",
        "AS5710A AccessControl, QueryTimeout",
        "QueryTimeout is answered with the seconds after which control lapses; 0 means never.",
        (ask(A, QueryTimeout(), ReportTimeout),),
    ),
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
    Check(
        "access.release-uncontrolled",
        "Answers ReleaseControl when nobody has control",
        "AS5710A AccessControl, NotControlled: ReleaseControl",
        "ReleaseControl is answered with RejectControl 0 even without control.",
        (send(A, ReleaseControl()), rejected(A, unless=_left_open_in_1_0)),
    ),
    Check(
        "access.release-by-other",
        "Ignores ReleaseControl of others than its controller",
        "AS5710A AccessControl, Controlled: ReleaseControl, guard on the sender",
        "ReleaseControl of a client without control is not answered and has no effect.",
        (
            take(A, LOW),
            send(B, ReleaseControl()),
            expect_none(B, RejectControl, "it has no control", tolerated=True),
            kept(A, LOW),
        ),
    ),
    Check(
        "access.release-after-preemption",
        "Ignores ReleaseControl of its former controller",
        "AS5710A AccessControl, Controlled: ReleaseControl, guard on the sender",
        "A client that was preempted cannot release the control of its successor.",
        (take(A, LOW), take(B, HIGH), send(A, ReleaseControl()), kept(B, HIGH)),
    ),
    Check(
        "access.timeout",
        "Takes control back from a silent controller after the announced timeout",
        "AS5710A AccessControl, Controlled: Timedout; ReportTimeout",
        "RejectControl 0 comes between 0.8 and 1.5 of the announced timeout, and not before.",
        (timeout_in_reach(), take(A, LOW), holds(A, 0.8), lapses(A, 0.7), uncontrolled()),
    ),
    Check(
        "access.timeout-renewed",
        "Counts the timeout anew when its controller asks again",
        "AS5710A AccessControl, Controlled: RequestControl of the controller restarts the timer",
        "A controller that asks again within the timeout keeps control past its first end.",
        (timeout_in_reach(), take(A, LOW), holds(A, 0.6), request(A, LOW, ACCEPTED), holds(A, 0.7)),
    ),
)
