"""Checks of Management: the states of the target (AS5710A, protocol behaviour).

No command that moves anything is sent. Emergencies are cleared by those who set them, also when a
check fails or the run is interrupted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance import access
from jausml.live.peers.conformance.check import check
from jausml.live.peers.conformance.session import NOBODY
from jausml.live.peers.services import controller_of
from jausml.runtime.messages import (
    ClearEmergency,
    ConfirmControl,
    QueryStatus,
    RejectControl,
    ReleaseControl,
    ReportStatus,
    RequestControl,
    Reset,
    Resume,
    SetEmergency,
    Shutdown,
    Standby,
)
from jausml.runtime.services.definitions import Status
from jausml.runtime.transports.packets.packet import Priority

if TYPE_CHECKING:
    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.wire.message import Message

STOP = 1
"""EmergencyCode STOP (AS5710A, SetEmergency)."""

_SET_0 = b"\x06\x00\x00\x00"
_CLEAR_0 = b"\x07\x00\x00\x00"
"""SetEmergency and ClearEmergency with code 0, which our own codec refuses."""

NOT_AVAILABLE = RejectControl.ResponseCode.NOT_AVAILABLE


def requires(session: Session) -> str:
    """Returns why the group cannot run, or nothing."""
    return session.missing("Management") or access.requires(session)


@check(
    "management.standby",
    "Waits in Standby without a controller",
    "AS5710A Management, Init: Initialized; ReportStatus",
)
def standby(session: Session) -> None:
    """ReportStatus says 2 (STANDBY) and 0 in its reserved field."""
    report = session.first.ask(QueryStatus(), ReportStatus)
    session.require(
        report.status == Status.STANDBY,
        f"ReportStatus says {report.status} instead of 2 (STANDBY) without a controller",
    )
    if report.reserved:
        session.note(f"the reserved field of ReportStatus is {report.reserved} instead of 0")


@check(
    "management.control-keeps-standby",
    "Stays in Standby when control is taken",
    "AS5710A Management, Standby; AccessControl, RequestControl",
)
def control_keeps_standby(session: Session) -> None:
    """Only Resume leads to Ready, not RequestControl."""
    session.take(session.first, session.low)
    _in(session, Status.STANDBY, "RequestControl")


@check(
    "management.resume",
    "Resumes for its controller",
    "AS5710A Management, Standby (Controlled): Resume",
)
def resume(session: Session) -> None:
    """Resume of the controller leads from Standby to Ready."""
    session.take(session.first, session.low)
    session.first.send(Resume())
    _comes_to(session, Status.READY, "Resume")


@check(
    "management.standby-command",
    "Goes to Standby for its controller",
    "AS5710A Management, Ready (Controlled): Standby",
)
def standby_command(session: Session) -> None:
    """Standby of the controller leads from Ready to Standby; control is kept."""
    session.make_ready(session.first)
    session.first.send(Standby())
    _comes_to(session, Status.STANDBY, "Standby")
    session.require(session.controls(session.first), "control was lost with Standby")


@check(
    "management.resume-uncontrolled",
    "Ignores Resume without a controller",
    "AS5710A Management, Standby: Resume, guard on the sender",
)
def resume_uncontrolled(session: Session) -> None:
    """Resume of a client without control has no effect and no answer."""
    _ignored(session, session.first, Resume(), Status.STANDBY)


@check(
    "management.resume-by-other",
    "Ignores Resume of others than its controller",
    "AS5710A Management, Standby: Resume, guard on the sender",
)
def resume_by_other(session: Session) -> None:
    """Resume of a client without control has no effect while another one has it."""
    session.take(session.first, session.low)
    _ignored(session, session.second, Resume(), Status.STANDBY)


@check(
    "management.standby-by-other",
    "Ignores Standby of others than its controller",
    "AS5710A Management, Ready: Standby, guard on the sender",
)
def standby_by_other(session: Session) -> None:
    """Standby of a client without control does not lead out of Ready."""
    session.make_ready(session.first)
    _ignored(session, session.second, Standby(), Status.READY)


@check(
    "management.reset-by-other",
    "Ignores Reset of others than its controller",
    "AS5710A Management, Ready: Reset, guard on the sender",
)
def reset_by_other(session: Session) -> None:
    """Reset of a client without control does not lead out of Ready."""
    session.make_ready(session.first)
    _ignored(session, session.second, Reset(), Status.READY)


@check(
    "management.release-ends-ready",
    "Leaves Ready when control is released",
    "AS5710A Management, Controlled to NotControlled",
)
def release_ends_ready(session: Session) -> None:
    """A Ready component without a controller would go on moving; it must go to Standby."""
    session.make_ready(session.first)
    session.first.send(ReleaseControl())
    session.first.find(RejectControl)
    _comes_to(session, Status.STANDBY, "ReleaseControl")


@check(
    "management.timeout-ends-ready",
    "Leaves Ready when control lapses",
    "AS5710A Management, Controlled to NotControlled; AccessControl, Timedout",
)
def timeout_ends_ready(session: Session) -> None:
    """A Ready component whose controller fell silent must go to Standby."""
    seconds = access.timeout_in_reach(session)
    session.make_ready(session.first)
    session.first.find(RejectControl, within=1.5 * seconds + 0.5)
    _comes_to(session, Status.STANDBY, f"{seconds} s without its controller")


@check(
    "management.reset",
    "Initialises anew for its controller in Ready",
    "AS5710A Management, Ready (Controlled): Reset",
)
def reset(session: Session) -> None:
    """Reset leads through Init to Standby; the controller is told RejectControl 0."""
    session.make_ready(session.first)
    session.first.send(Reset())
    code = session.first.expect(RejectControl, "Reset").response_code
    session.require(code == 0, f"Reset is followed by RejectControl {code} instead of 0")
    _comes_to(session, Status.STANDBY, "Reset")
    _nobody_controls(session, "Reset")


@check(
    "management.reset-in-standby",
    "Initialises anew for its controller in Standby",
    "AS5710A v1.1 Management, Standby (Controlled): Reset",
)
def reset_in_standby(session: Session) -> None:
    """As in Ready; AS5710 before revision A knows no Reset in Standby."""
    session.skip_unless(not session.is_v1_0("Management"), "Management 1.0 resets in Ready only")
    session.take(session.first, session.low)
    session.first.send(Reset())
    session.first.expect(RejectControl, "Reset in Standby")
    _comes_to(session, Status.STANDBY, "Reset")
    _nobody_controls(session, "Reset")


@check(
    "management.emergency",
    "Enters Emergency for anybody",
    "AS5710A Management, default_state: SetEmergency",
)
def emergency(session: Session) -> None:
    """SetEmergency with code 1 (STOP) of a client without control leads to Emergency."""
    session.second.send(SetEmergency(emergency_code=STOP), Priority.SAFETY_CRITICAL)
    _comes_to(session, Status.EMERGENCY, "SetEmergency")


@check(
    "management.emergency-ready",
    "Enters Emergency from Ready and lets go of its controller",
    "AS5710A Management, default_state: SetEmergency; RejectControl",
)
def emergency_ready(session: Session) -> None:
    """The controller is told RejectControl: 1 in v1.1, 0 in v1.0; nobody has control then."""
    session.make_ready(session.first)
    _set_emergency(session, session.second)
    rejection = session.first.find(RejectControl)
    _comes_to(session, Status.EMERGENCY, "SetEmergency")
    session.require(rejection is not None, "the controller is not told that it lost control")
    expected = 0 if session.is_v1_0("Management") else int(NOT_AVAILABLE)
    if rejection is not None and rejection.response_code != expected:
        session.note(f"RejectControl {rejection.response_code} instead of {expected}")
    if not session.is_v1_0("Management"):
        _nobody_controls(session, "SetEmergency")


@check(
    "management.emergency-no-control",
    "Gives no control in Emergency",
    "AS5710A AccessControl, NotControlled: RequestControl, control unavailable",
)
def emergency_no_control(session: Session) -> None:
    """RequestControl is answered with 1 (NOT_AVAILABLE)."""
    _set_emergency(session, session.second)
    session.first.send(RequestControl(authority_code=session.low))
    code = session.first.expect(ConfirmControl, "RequestControl in Emergency").response_code
    session.require(
        code == ConfirmControl.ResponseCode.NOT_AVAILABLE,
        f"RequestControl in Emergency is answered with ConfirmControl {code} instead of 1",
    )


@check(
    "management.emergency-release",
    "Answers ReleaseControl in Emergency by who set it",
    "AS5710A v1.1 AccessControl, NotControlled: ReleaseControl, unavailable",
)
def emergency_release(session: Session) -> None:
    """RejectControl 0 for the client that set the emergency, 1 for any other."""
    session.skip_unless(
        not session.is_v1_0("AccessControl"), "AccessControl 1.0 does not tell them apart"
    )
    _set_emergency(session, session.second)
    for client, expected in ((session.first, 1), (session.second, 0)):
        client.send(ReleaseControl())
        code = client.expect(RejectControl, "ReleaseControl in Emergency").response_code
        session.require(
            code == expected,
            f"ReleaseControl of {client.address} in Emergency is answered with RejectControl "
            f"{code} instead of {expected}",
        )


@check(
    "management.emergency-resume",
    "Ignores Resume in Emergency",
    "AS5710A Management, Emergency",
)
def emergency_resume(session: Session) -> None:
    """Neither the former controller nor who set the emergency can resume."""
    session.make_ready(session.first)
    _set_emergency(session, session.second)
    session.first.find(RejectControl)
    for client in (session.first, session.second):
        client.send(Resume())
    _in(session, Status.EMERGENCY, "Resume in Emergency")


@check(
    "management.emergency-reset",
    "Ignores Reset in Emergency",
    "AS5710A v1.1 Management, Emergency: Reset only once the emergency is cleared",
)
def emergency_reset(session: Session) -> None:
    """Nobody can get round an emergency by a Reset; Management 1.0 lets anybody do so."""
    session.skip_unless(not session.is_v1_0("Management"), "Management 1.0 resets in Emergency")
    _set_emergency(session, session.second)
    for client in (session.first, session.second):
        client.send(Reset())
    _in(session, Status.EMERGENCY, "Reset in Emergency")


@check(
    "management.clear-by-other",
    "Ignores ClearEmergency of those who set none",
    "AS5710A Management, Emergency: ClearEmergency, guard on the sender",
)
def clear_by_other(session: Session) -> None:
    """ClearEmergency of a client that set no emergency leaves the target in Emergency."""
    _set_emergency(session, session.second)
    session.first.send(ClearEmergency(emergency_code=STOP))
    _in(session, Status.EMERGENCY, "ClearEmergency of another client")


@check(
    "management.clear",
    "Leaves Emergency when it is cleared",
    "AS5710A Management, Emergency: ClearEmergency; Released",
)
def clear(session: Session) -> None:
    """ClearEmergency of the one client that set it leads to Standby.

    AS5710 before revision A returns to the state before; without a controller that is Standby too.
    """
    _set_emergency(session, session.second)
    session.second.send(ClearEmergency(emergency_code=STOP))
    _comes_to(session, Status.STANDBY, "ClearEmergency")


@check(
    "management.clear-after-ready",
    "Does not come back to Ready from Emergency",
    "AS5710A Management, Emergency: ClearEmergency; v1.0 pops to the state before",
)
def clear_after_ready(session: Session) -> None:
    """An emergency set in Ready ends in Standby (v1.1); v1.0 may come back to Ready."""
    session.make_ready(session.first)
    _set_emergency(session, session.second)
    session.second.send(ClearEmergency(emergency_code=STOP))
    if session.is_v1_0("Management") and session.reaches(Status.READY):
        session.note("comes back to Ready, as Management 1.0 says; revision A says Standby")
        return
    _comes_to(session, Status.STANDBY, "ClearEmergency")


@check(
    "management.emergency-two-clients",
    "Stays in Emergency until everybody who set it has cleared it",
    "AS5710A Management, Emergency: ClearEmergency, set of senders",
)
def emergency_two_clients(session: Session) -> None:
    """Two clients set the emergency; after the first one cleared it, it lasts; then it ends."""
    _set_emergency(session, session.first)
    _set_emergency(session, session.second)
    session.first.send(ClearEmergency(emergency_code=STOP))
    _in(session, Status.EMERGENCY, "ClearEmergency of one of two clients")
    session.second.send(ClearEmergency(emergency_code=STOP))
    _comes_to(session, Status.STANDBY, "ClearEmergency of both clients")


@check(
    "management.emergency-code-0",
    "Takes emergency code 0 for STOP too",
    "Practice: components of the JAUS Tool Set send 0; AS5710A lists 1 (STOP) alone",
)
def emergency_code_0(session: Session) -> None:
    """A component that ignores code 0 conforms, but does not stop for such a peer."""
    session.second.owe(ClearEmergency, _CLEAR_0)
    session.second.put(session.second.packet(_SET_0, priority=Priority.SAFETY_CRITICAL))
    if not session.reaches(Status.EMERGENCY):
        session.note("SetEmergency with code 0 is ignored; JAUS Tool Set peers send it")
        return
    session.second.put(session.second.packet(_CLEAR_0))
    _comes_to(session, Status.STANDBY, "ClearEmergency with code 0")


@check(
    "management.shutdown-by-other",
    "Ignores Shutdown of others than its controller",
    "AS5710A Management, Ready: Shutdown, guard on the sender",
    destructive=True,
)
def shutdown_by_other(session: Session) -> None:
    """Shutdown of a client without control does not lead out of Ready."""
    session.make_ready(session.first)
    _ignored(session, session.second, Shutdown(), Status.READY)


@check(
    "management.shutdown",
    "Shuts down for its controller",
    "AS5710A Management, Ready (Controlled): Shutdown",
    destructive=True,
)
def shutdown(session: Session) -> None:
    """The controller is told RejectControl: 1 in v1.1, 0 in v1.0.

    The target then reports 3 (SHUTDOWN) or does not answer any more.
    """
    session.make_ready(session.first)
    session.first.send(Shutdown())
    code = session.first.expect(RejectControl, "Shutdown").response_code
    expected = 0 if session.is_v1_0("Management") else int(NOT_AVAILABLE)
    if code != expected:
        session.note(f"RejectControl {code} instead of {expected}")
    report = session.first.asked(QueryStatus(), ReportStatus, attempts=1)
    session.require(
        report is None or report.status == Status.SHUTDOWN,
        f"the target reports status {report and report.status} after Shutdown",
    )


CHECKS = (
    standby,
    control_keeps_standby,
    resume,
    standby_command,
    resume_uncontrolled,
    resume_by_other,
    standby_by_other,
    reset_by_other,
    release_ends_ready,
    timeout_ends_ready,
    reset,
    reset_in_standby,
    emergency,
    emergency_ready,
    emergency_no_control,
    emergency_release,
    emergency_resume,
    emergency_reset,
    clear_by_other,
    clear,
    clear_after_ready,
    emergency_two_clients,
    emergency_code_0,
    shutdown_by_other,
    shutdown,
)


def _set_emergency(session: Session, client: Client) -> None:
    """Sets an emergency with the priority that such messages deserve."""
    client.send(SetEmergency(emergency_code=STOP), Priority.SAFETY_CRITICAL)
    session.skip_unless(
        session.reaches(Status.EMERGENCY),
        "the target does not enter Emergency; see management.emergency",
    )


def _comes_to(session: Session, status: Status, after: str) -> None:
    session.require(
        session.reaches(status),
        f"after {after} the target is in {session.status().name} instead of {status.name}",
    )


def _in(session: Session, status: Status, after: str) -> None:
    """Like `_comes_to`, but the state must hold for the quiet time."""
    session.probe.wait(lambda: False, session.probe.quiet)
    present = session.status()
    session.require(
        present is status, f"after {after} the target is in {present.name} instead of {status.name}"
    )


def _ignored(session: Session, client: Client, command: Message, status: Status) -> None:
    client.send(command)
    client.expect_silence(f"{command.NAME} of {client.address} is to be ignored")
    _in(session, status, f"{command.NAME} of {client.address}, which has no control,")


def _nobody_controls(session: Session, after: str) -> None:
    report = session.seen_control()
    if report is None:
        return
    session.require(
        controller_of(report) == NOBODY,
        f"{controller_of(report)} still has control after {after}",
    )
