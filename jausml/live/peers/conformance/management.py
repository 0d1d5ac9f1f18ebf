"""Checks of Management: the states of the target (AS5710A, protocol behaviour).

No command that moves anything is sent. Emergencies are cleared by those who set them, also when a
check fails or the run is interrupted.
"""

from __future__ import annotations

from jausml.live.peers.conformance import access
from jausml.live.peers.conformance.access import (
    control_timeout,
    controlled_by,
    nobody_controls,
    rejected,
    request,
    timeout_in_reach,
)
from jausml.live.peers.conformance.check import Check, Step, step
from jausml.live.peers.conformance.session import Authority, Session
from jausml.live.peers.conformance.steps import (
    A,
    B,
    ask,
    expect,
    has,
    only_in_1_1,
    put,
    ready,
    send,
    should_have,
    silence,
    since_1_1,
    take,
)
from jausml.runtime.messages import (
    ClearEmergency,
    ConfirmControl,
    QueryStatus,
    RejectControl,
    ReleaseControl,
    ReportStatus,
    Reset,
    Resume,
    SetEmergency,
    Shutdown,
    Standby,
)
from jausml.runtime.services.definitions import Status
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message

STANDBY, READY, EMERGENCY = Status.STANDBY, Status.READY, Status.EMERGENCY
LOW = Authority.LOW

SET, CLEAR = SetEmergency(emergency_code=1), ClearEmergency(emergency_code=1)
"""The messages of an emergency of code STOP (AS5710A)."""

_SET_0 = b"\x06\x00\x00\x00"
_CLEAR_0 = b"\x07\x00\x00\x00"
"""SetEmergency and ClearEmergency with code 0, which our own codec refuses."""

NOT_AVAILABLE = RejectControl.ResponseCode.NOT_AVAILABLE


def requires(session: Session) -> str:
    """Returns why the group cannot run, or nothing."""
    return session.missing("Management") or access.requires(session)


@step
def may_hear(session: Session, client: int, kind: type[Message], timeouts: float = 0) -> None:
    """Waits for a message that a client may be sent now, perhaps as control lapses."""
    within = timeouts * control_timeout(session) + 0.5 if timeouts else None
    session.client(client).find(kind, within=within)


@step
def comes_to(session: Session, status: Status, in_1_0: Status | None = None) -> None:
    """The target comes to a state; Management 1.0 may name another one, which is noted."""
    if in_1_0 is not None and session.is_v1_0("Management") and session.reaches(in_1_0):
        session.note(f"comes to {in_1_0.name}, as Management 1.0 says, and not to {status.name}")
        return
    session.require(
        session.reaches(status),
        f"after {session.latest} the target is in {session.status().name} instead of {status.name}",
    )


@step
def remains(session: Session, status: Status) -> None:
    """Like `comes_to`, but the state must hold for the quiet time."""
    session.pause()
    present = session.status()
    session.require(
        present is status,
        f"after {session.latest} the target is in {present.name} instead of {status.name}",
    )


@step
def ignored(session: Session, client: int, command: Message, status: Status) -> None:
    """A command of a client without control gets no answer, and the target stays in its state."""
    session.send(client, command)
    silence(client, f"{session.latest} is to be ignored")(session)
    remains(status)(session)


@step
def dismissed(session: Session, client: int) -> None:
    """A controller is told that control is not available, in v1.0 that it is released."""
    code = session.client(client).expect(RejectControl, session.latest).response_code
    expected = 0 if session.is_v1_0("Management") else int(NOT_AVAILABLE)
    if code != expected:
        session.note(f"RejectControl {code} instead of {expected}")


@step
def emergency(session: Session, client: int) -> None:
    """A client sets an emergency; the check is skipped where that leads not to Emergency."""
    session.send(client, SET, Priority.SAFETY_CRITICAL)
    session.skip_unless(
        session.reaches(EMERGENCY), "the target does not enter Emergency; see management.emergency"
    )


@step
def _set_0(session: Session, client: int) -> None:
    """A client sets an emergency of code 0, which it owes to clear."""
    test_client = session.client(client)
    test_client.owe(ClearEmergency, _CLEAR_0)
    test_client.put(test_client.packet(_SET_0, priority=Priority.SAFETY_CRITICAL))


@step
def _entered(session: Session, note: str, *steps: Step) -> None:
    """Takes steps in Emergency; notes where the target is not there."""
    if not session.reaches(EMERGENCY):
        session.note(note)
        return
    for check_step in steps:
        check_step(session)


def is_down(session: Session) -> None:
    """The target reports that it is shut down, or does not answer any more."""
    report = session.first.asked(QueryStatus(), ReportStatus, attempts=1)
    session.require(
        report is None or report.status == Status.SHUTDOWN,
        f"the target reports status {report and report.status} after Shutdown",
    )


CHECKS = (
    Check(
        "management.standby",
        "Waits in Standby without a controller",
        "AS5710A Management, Init: Initialized; ReportStatus",
        "ReportStatus says 2 (STANDBY) and 0 in its reserved field.",
        (ask(A, QueryStatus(), ReportStatus, has(status=STANDBY), should_have(reserved=0)),),
    ),
    Check(
        "management.control-keeps-standby",
        "Stays in Standby when control is taken",
        "AS5710A Management, Standby; AccessControl, RequestControl",
        "Only Resume leads to Ready, not RequestControl.",
        (take(A, LOW), remains(STANDBY)),
    ),
    Check(
        "management.resume",
        "Resumes for its controller",
        "AS5710A Management, Standby (Controlled): Resume",
        "Resume of the controller leads from Standby to Ready.",
        (take(A, LOW), send(A, Resume()), comes_to(READY)),
    ),
    Check(
        "management.standby-command",
        "Goes to Standby for its controller",
        "AS5710A Management, Ready (Controlled): Standby",
        "Standby of the controller leads from Ready to Standby; control is kept.",
        (ready(A), send(A, Standby()), comes_to(STANDBY), controlled_by(A, LOW)),
    ),
    Check(
        "management.resume-uncontrolled",
        "Ignores Resume without a controller",
        "AS5710A Management, Standby: Resume, guard on the sender",
        "Resume of a client without control has no effect and no answer.",
        (ignored(A, Resume(), STANDBY),),
    ),
    Check(
        "management.resume-by-other",
        "Ignores Resume of others than its controller",
        "AS5710A Management, Standby: Resume, guard on the sender",
        "Resume of a client without control has no effect while another one has it.",
        (take(A, LOW), ignored(B, Resume(), STANDBY)),
    ),
    Check(
        "management.standby-by-other",
        "Ignores Standby of others than its controller",
        "AS5710A Management, Ready: Standby, guard on the sender",
        "Standby of a client without control does not lead out of Ready.",
        (ready(A), ignored(B, Standby(), READY)),
    ),
    Check(
        "management.reset-by-other",
        "Ignores Reset of others than its controller",
        "AS5710A Management, Ready: Reset, guard on the sender",
        "Reset of a client without control does not lead out of Ready.",
        (ready(A), ignored(B, Reset(), READY)),
    ),
    Check(
        "management.release-ends-ready",
        "Leaves Ready when control is released",
        "AS5710A Management, Controlled to NotControlled",
        "A Ready component without a controller would go on moving; it must go to Standby.",
        (ready(A), send(A, ReleaseControl()), may_hear(A, RejectControl), comes_to(STANDBY)),
    ),
    Check(
        "management.timeout-ends-ready",
        "Leaves Ready when control lapses",
        "AS5710A Management, Controlled to NotControlled; AccessControl, Timedout",
        "A Ready component whose controller fell silent must go to Standby.",
        (timeout_in_reach(), ready(A), may_hear(A, RejectControl, 1.5), comes_to(STANDBY)),
    ),
    Check(
        "management.reset",
        "Initialises anew for its controller in Ready",
        "AS5710A Management, Ready (Controlled): Reset",
        "Reset leads through Init to Standby; the controller is told RejectControl 0.",
        (ready(A), send(A, Reset()), rejected(A), comes_to(STANDBY), nobody_controls()),
    ),
    Check(
        "management.reset-in-standby",
        "Initialises anew for its controller in Standby",
        "AS5710A v1.1 Management, Standby (Controlled): Reset",
        "As in Ready; AS5710 before revision A knows no Reset in Standby.",
        (
            since_1_1("Management", "Management 1.0 resets in Ready only"),
            take(A, LOW),
            send(A, Reset()),
            expect(A, RejectControl),
            comes_to(STANDBY),
            nobody_controls(),
        ),
    ),
    Check(
        "management.emergency",
        "Enters Emergency for anybody",
        "AS5710A Management, default_state: SetEmergency",
        "SetEmergency with code 1 (STOP) of a client without control leads to Emergency.",
        (send(B, SET, Priority.SAFETY_CRITICAL), comes_to(EMERGENCY)),
    ),
    Check(
        "management.emergency-ready",
        "Enters Emergency from Ready and lets go of its controller",
        "AS5710A Management, default_state: SetEmergency; RejectControl",
        "The controller is told RejectControl: 1 in v1.1, 0 in v1.0; nobody has control then.",
        (ready(A), emergency(B), dismissed(A), only_in_1_1("Management", nobody_controls())),
    ),
    Check(
        "management.emergency-no-control",
        "Gives no control in Emergency",
        "AS5710A AccessControl, NotControlled: RequestControl, control unavailable",
        "RequestControl is answered with 1 (NOT_AVAILABLE).",
        (emergency(B), request(A, LOW, ConfirmControl.ResponseCode.NOT_AVAILABLE)),
    ),
    Check(
        "management.emergency-release",
        "Answers ReleaseControl in Emergency by who set it",
        "AS5710A v1.1 AccessControl, NotControlled: ReleaseControl, unavailable",
        "RejectControl 0 for the client that set the emergency, 1 for any other.",
        (
            since_1_1("AccessControl", "AccessControl 1.0 does not tell them apart"),
            emergency(B),
            send(A, ReleaseControl()),
            rejected(A, 1),
            send(B, ReleaseControl()),
            rejected(B),
        ),
    ),
    Check(
        "management.emergency-resume",
        "Ignores Resume in Emergency",
        "AS5710A Management, Emergency",
        "Neither the former controller nor who set the emergency can resume.",
        (
            ready(A),
            emergency(B),
            may_hear(A, RejectControl),
            send(A, Resume()),
            send(B, Resume()),
            remains(EMERGENCY),
        ),
    ),
    Check(
        "management.emergency-reset",
        "Ignores Reset in Emergency",
        "AS5710A v1.1 Management, Emergency: Reset only once the emergency is cleared",
        "Nobody can get round an emergency by a Reset; Management 1.0 lets anybody do so.",
        (
            since_1_1("Management", "Management 1.0 resets in Emergency"),
            emergency(B),
            send(A, Reset()),
            send(B, Reset()),
            remains(EMERGENCY),
        ),
    ),
    Check(
        "management.clear-by-other",
        "Ignores ClearEmergency of those who set none",
        "AS5710A Management, Emergency: ClearEmergency, guard on the sender",
        "ClearEmergency of a client that set no emergency leaves the target in Emergency.",
        (emergency(B), send(A, CLEAR), remains(EMERGENCY)),
    ),
    Check(
        "management.clear",
        "Leaves Emergency when it is cleared",
        "AS5710A Management, Emergency: ClearEmergency; Released",
        "ClearEmergency of the one client that set it leads to Standby.\n\n"
        "AS5710 before revision A returns to the state before; without a controller that is "
        "Standby too.",
        (emergency(B), send(B, CLEAR), comes_to(STANDBY)),
    ),
    Check(
        "management.clear-after-ready",
        "Does not come back to Ready from Emergency",
        "AS5710A Management, Emergency: ClearEmergency; v1.0 pops to the state before",
        "An emergency set in Ready ends in Standby (v1.1); v1.0 may come back to Ready.",
        (ready(A), emergency(B), send(B, CLEAR), comes_to(STANDBY, in_1_0=READY)),
    ),
    Check(
        "management.emergency-two-clients",
        "Stays in Emergency until everybody who set it has cleared it",
        "AS5710A Management, Emergency: ClearEmergency, set of senders",
        "Two clients set the emergency; after the first one cleared it, it lasts; then it ends.",
        (
            emergency(A),
            emergency(B),
            send(A, CLEAR),
            remains(EMERGENCY),
            send(B, CLEAR),
            comes_to(STANDBY),
        ),
    ),
    Check(
        "management.emergency-code-0",
        "Takes emergency code 0 for STOP too",
        "Practice: components of the JAUS Tool Set send 0; AS5710A lists 1 (STOP) alone",
        "A component that ignores code 0 conforms, but does not stop for such a peer.",
        (
            _set_0(B),
            _entered(
                "SetEmergency with code 0 is ignored; JAUS Tool Set peers send it",
                put(B, "ClearEmergency with code 0", _CLEAR_0),
                comes_to(STANDBY),
            ),
        ),
    ),
    Check(
        "management.shutdown-by-other",
        "Ignores Shutdown of others than its controller",
        "AS5710A Management, Ready: Shutdown, guard on the sender",
        "Shutdown of a client without control does not lead out of Ready.",
        (ready(A), ignored(B, Shutdown(), READY)),
        destructive=True,
    ),
    Check(
        "management.shutdown",
        "Shuts down for its controller",
        "AS5710A Management, Ready (Controlled): Shutdown",
        "The controller is told RejectControl: 1 in v1.1, 0 in v1.0.\n\n"
        "The target then reports 3 (SHUTDOWN) or does not answer any more.",
        (ready(A), send(A, Shutdown()), dismissed(A), is_down),
        destructive=True,
    ),
)
