"""Checks of AccessControl: who controls the target (AS5710A, protocol behaviour)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import check
from jausml.live.peers.conformance.session import NOBODY
from jausml.live.peers.conformance.verdicts import CheckFailed
from jausml.live.peers.services import controller_of
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
    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.session import Session

ACCEPTED = ConfirmControl.ResponseCode.CONTROL_ACCEPTED
NOT_AVAILABLE = ConfirmControl.ResponseCode.NOT_AVAILABLE
INSUFFICIENT = ConfirmControl.ResponseCode.INSUFFICIENT_AUTHORITY
RELEASED = RejectControl.ResponseCode.CONTROL_RELEASED

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
    session.first.send(RequestControl(authority_code=session.low))
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


@check(
    "access.uncontrolled",
    "Reports no controller and its default authority",
    "AS5710A AccessControl, NotControlled (entry), QueryControl, QueryAuthority",
)
def uncontrolled(session: Session) -> None:
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
    "access.request",
    "Gives control to the first who asks",
    "AS5710A AccessControl, NotControlled: RequestControl",
)
def request(session: Session) -> None:
    """RequestControl with sufficient authority is confirmed with 0.

    ReportControl then names the client and its authority.
    """
    _request(session.first, session.low, ACCEPTED)
    _controlled_by(session, session.first, session.low)


@check(
    "access.insufficient",
    "Refuses an authority below its default",
    "AS5710A AccessControl, NotControlled: RequestControl, default authority > requested",
)
def insufficient(session: Session) -> None:
    """RequestControl below the default authority is answered with 2 and changes nothing."""
    session.skip_unless(session.default_authority > 0, "the default authority is 0, or not told")
    _request(session.first, session.default_authority - 1, INSUFFICIENT)
    _uncontrolled(session)


@check(
    "access.keep-alive",
    "Confirms its controller again and takes its new authority",
    "AS5710A AccessControl, Controlled: RequestControl of the controller",
)
def keep_alive(session: Session) -> None:
    """A controller that asks again is confirmed with 0; its authority becomes the new one."""
    session.take(session.first, session.low)
    _request(session.first, session.high, ACCEPTED)
    _controlled_by(session, session.first, session.high)
    _request(session.first, session.low, ACCEPTED)
    _controlled_by(session, session.first, session.low)


@check(
    "access.controller-below-default",
    "Drops a controller that asks with less than the default authority",
    "AS5710A AccessControl, Controlled: RequestControl of the controller, default > requested",
)
def controller_below_default(session: Session) -> None:
    """The controller is told RejectControl 0, and nobody has control."""
    session.skip_unless(session.default_authority > 0, "the default authority is 0, or not told")
    session.take(session.first, session.low)
    session.first.send(RequestControl(authority_code=session.default_authority - 1))
    _rejected(session.first, "RequestControl below the default authority")
    _uncontrolled(session)


@check(
    "access.preemption",
    "Lets a higher authority take control",
    "AS5710A AccessControl, Controlled: RequestControl of another, current < requested",
)
def preemption(session: Session) -> None:
    """The new controller is confirmed with 0; the old one is told RejectControl 0."""
    session.take(session.first, session.low)
    _request(session.second, session.high, ACCEPTED)
    _rejected(session.first, "being preempted")
    _controlled_by(session, session.second, session.high)


@check(
    "access.equal-authority",
    "Does not let the same authority take control",
    "AS5710A AccessControl, Controlled: RequestControl of another, current >= requested",
)
def equal_authority(session: Session) -> None:
    """The second client is answered with 2; the first one keeps control."""
    session.take(session.first, session.middle)
    _request(session.second, session.middle, INSUFFICIENT)
    session.first.expect_none(RejectControl, "nobody with a higher authority asked")
    _controlled_by(session, session.first, session.middle)


@check(
    "access.lower-authority",
    "Does not let a lower authority take control",
    "AS5710A AccessControl, Controlled: RequestControl of another, current >= requested",
)
def lower_authority(session: Session) -> None:
    """The second client is answered with 2; the first one keeps control."""
    session.take(session.first, session.high)
    _request(session.second, session.low, INSUFFICIENT)
    session.first.expect_none(RejectControl, "nobody with a higher authority asked")
    _controlled_by(session, session.first, session.high)


@check(
    "access.set-authority",
    "Lets its controller lower its authority",
    "AS5710A AccessControl, Controlled: SetAuthority, default <= new <= current",
)
def set_authority(session: Session) -> None:
    """ReportAuthority then says the new one, and a client between the two may take control."""
    session.take(session.first, session.high)
    session.first.send(SetAuthority(authority_code=session.low))
    _controlled_by(session, session.first, session.low)
    _request(session.second, session.middle, ACCEPTED)


@check(
    "access.set-authority-raised",
    "Does not let its controller raise its authority by SetAuthority",
    "AS5710A AccessControl, Controlled: SetAuthority, guard new <= current",
)
def set_authority_raised(session: Session) -> None:
    """SetAuthority above the present authority has no effect."""
    session.take(session.first, session.low)
    session.first.send(SetAuthority(authority_code=session.high))
    _controlled_by(session, session.first, session.low)


@check(
    "access.set-authority-below-default",
    "Does not let its controller fall below the default authority",
    "AS5710A AccessControl, Controlled: SetAuthority, guard default <= new",
)
def set_authority_below_default(session: Session) -> None:
    """SetAuthority below the default authority has no effect."""
    session.skip_unless(session.default_authority > 0, "the default authority is 0, or not told")
    session.take(session.first, session.low)
    session.first.send(SetAuthority(authority_code=session.default_authority - 1))
    _controlled_by(session, session.first, session.low)


@check(
    "access.set-authority-by-other",
    "Ignores SetAuthority of others than its controller",
    "AS5710A AccessControl, Controlled: SetAuthority, guard on the sender",
)
def set_authority_by_other(session: Session) -> None:
    """SetAuthority of a client without control has no effect."""
    session.take(session.first, session.high)
    session.second.send(SetAuthority(authority_code=session.low))
    _controlled_by(session, session.first, session.high)


@check(
    "access.release",
    "Lets its controller release control",
    "AS5710A AccessControl, Controlled: ReleaseControl of the controller",
)
def release(session: Session) -> None:
    """ReleaseControl is answered with RejectControl 0, and nobody has control."""
    session.take(session.first, session.low)
    session.first.send(ReleaseControl())
    _rejected(session.first, "ReleaseControl")
    _uncontrolled(session)


@check(
    "access.release-uncontrolled",
    "Answers ReleaseControl when nobody has control",
    "AS5710A AccessControl, NotControlled: ReleaseControl",
)
def release_uncontrolled(session: Session) -> None:
    """ReleaseControl is answered with RejectControl 0 even without control."""
    session.first.send(ReleaseControl())
    if session.is_v1_0("AccessControl"):
        if session.first.find(RejectControl) is None:
            session.note("not answered; AS5710 before revision A leaves that open")
        return
    _rejected(session.first, "ReleaseControl without control")


@check(
    "access.release-by-other",
    "Ignores ReleaseControl of others than its controller",
    "AS5710A AccessControl, Controlled: ReleaseControl, guard on the sender",
)
def release_by_other(session: Session) -> None:
    """ReleaseControl of a client without control is not answered and has no effect."""
    session.take(session.first, session.low)
    session.second.send(ReleaseControl())
    if session.second.find(RejectControl, within=session.probe.quiet) is not None:
        session.note("ReleaseControl of a client without control is answered")
    session.first.expect_none(RejectControl, "another client asked for the release")
    _controlled_by(session, session.first, session.low)


@check(
    "access.release-after-preemption",
    "Ignores ReleaseControl of its former controller",
    "AS5710A AccessControl, Controlled: ReleaseControl, guard on the sender",
)
def release_after_preemption(session: Session) -> None:
    """A client that was preempted cannot release the control of its successor."""
    session.take(session.first, session.low)
    session.take(session.second, session.high)
    session.first.send(ReleaseControl())
    session.second.expect_none(RejectControl, "the former controller asked for the release")
    _controlled_by(session, session.second, session.high)


@check(
    "access.timeout",
    "Takes control back from a silent controller after the announced timeout",
    "AS5710A AccessControl, Controlled: Timedout; ReportTimeout",
)
def timeout(session: Session) -> None:
    """RejectControl 0 comes between 0.8 and 1.5 of the announced timeout, and not before."""
    seconds = timeout_in_reach(session)
    session.take(session.first, session.low)
    early = session.first.find(RejectControl, within=seconds * _EARLIEST)
    session.require(early is None, f"control lapsed before the announced {seconds} s")
    late = session.first.find(RejectControl, within=seconds * (_LATEST - _EARLIEST) + 0.5)
    session.require(late is not None, f"control did not lapse after the announced {seconds} s")
    _uncontrolled(session)


@check(
    "access.timeout-renewed",
    "Counts the timeout anew when its controller asks again",
    "AS5710A AccessControl, Controlled: RequestControl of the controller restarts the timer",
)
def timeout_renewed(session: Session) -> None:
    """A controller that asks again within the timeout keeps control past its first end."""
    seconds = timeout_in_reach(session)
    session.take(session.first, session.low)
    lost = session.first.find(RejectControl, within=seconds * 0.6)
    session.require(lost is None, f"control lapsed before the announced {seconds} s")
    _request(session.first, session.low, ACCEPTED)
    lost = session.first.find(RejectControl, within=seconds * 0.7)
    session.require(lost is None, "control lapsed although it was asked for again in time")


CHECKS = (
    uncontrolled,
    timeout_reported,
    request,
    insufficient,
    keep_alive,
    controller_below_default,
    preemption,
    equal_authority,
    lower_authority,
    set_authority,
    set_authority_raised,
    set_authority_below_default,
    set_authority_by_other,
    release,
    release_uncontrolled,
    release_by_other,
    release_after_preemption,
    timeout,
    timeout_renewed,
)


def _request(client: Client, authority: int, expected: ConfirmControl.ResponseCode) -> None:
    what = f"RequestControl of {client.address} with authority {authority}"
    client.send(RequestControl(authority_code=authority))
    code = client.expect(ConfirmControl, what).response_code
    if code != expected:
        raise CheckFailed(
            f"{what} is answered with ConfirmControl {code} instead of "
            f"{int(expected)} ({expected.name})"
        )


def _rejected(client: Client, what: str) -> None:
    code = client.expect(RejectControl, what).response_code
    if code != RELEASED:
        raise CheckFailed(f"{what} is answered with RejectControl {code} instead of 0")


def _controlled_by(session: Session, client: Client, authority: int) -> None:
    report = session.seen_control()
    if report is None:
        return
    session.require(
        controller_of(report) == str(client.address),
        f"ReportControl names {controller_of(report)} instead of {client.address}",
    )
    session.require(
        report.authority_code == authority,
        f"ReportControl says authority {report.authority_code} instead of {authority}",
    )


def _uncontrolled(session: Session) -> None:
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
