"""Management, row by row (AS5710 v1.1 and v1.0, Management, protocol behaviour)."""

from jausml.runtime import Status
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

from .state_tables import V1_0, Robot, Row, after, controlled, play, ready, rows

RELEASED = RejectControl(response_code=0)
REJECTED = RejectControl(response_code=1)
ACCEPTED = ConfirmControl(response_code=0)
NOT_AVAILABLE = ConfirmControl(response_code=1)
REFUSED = "component.command_refused"
EMERGENCY = ("bystander", SetEmergency())
CLEARED = ("bystander", ClearEmergency())
LOST = ("not ready", "control lost", "controller None")
"""Hooks that are called where control ends in Ready."""


def row(name, *given, when, **expected):
    settings = {"control_timeout": 4, **expected.pop("settings", {})}
    return Row(name, given, when, settings=settings, **expected)


def fails(stage):
    stage.component.fail("a motor is broken")


def status(value):
    return ReportStatus(status=value, reserved=0)


LIFE = (
    row("Init, Initialized: Standby", when=("client", QueryStatus(), status(2)),
        status=Status.STANDBY, controller=""),
    row("Standby, Resume of the controller: Ready", *controlled(), when=("client", Resume()),
        status=Status.READY, calls=("ready",)),
    row("Standby, Resume of another: ignored", *controlled(), when=("rival", Resume()),
        status=Status.STANDBY, counted=REFUSED),
    row("Standby, Resume without control: ignored", when=("client", Resume()),
        status=Status.STANDBY, counted=REFUSED),
    row("Ready, Standby of the controller: Standby", *ready(), when=("client", Standby()),
        status=Status.STANDBY, controller="client", calls=("not ready",)),
    row("Ready, Standby of another: ignored", *ready(), when=("rival", Standby()),
        status=Status.READY, counted=REFUSED, calls=()),
    row("Ready, Shutdown of the controller: Reject 1, Shutdown", *ready(),
        when=("client", Shutdown(), REJECTED), status=Status.SHUTDOWN, controller="",
        calls=(*LOST, "shutdown")),
    row("Ready, Shutdown of the controller, v1.0: Reject 0, Shutdown", *ready(),
        when=("client", Shutdown(), RELEASED), status=Status.SHUTDOWN, version=V1_0),
    row("Ready, Shutdown of another: ignored", *ready(), when=("rival", Shutdown()),
        status=Status.READY, counted=REFUSED, calls=()),
    row("Standby, Shutdown of the controller: ignored", *controlled(), when=("client", Shutdown()),
        status=Status.STANDBY, counted="management.shutdown_ignored", controller="client"),
    row("Ready, Reset of the controller: Init, Reject 0", *ready(),
        when=("client", Reset(), RELEASED), status=Status.STANDBY, controller="",
        calls=(*LOST, "initialize")),
    row("Ready, Reset of the controller, v1.0: Init, Reject 0", *ready(),
        when=("client", Reset(), RELEASED), status=Status.STANDBY, controller="", version=V1_0),
    row("Standby, Reset of the controller: Init, Reject 0", *controlled(),
        when=("client", Reset(), RELEASED), status=Status.STANDBY, controller="",
        calls=(*LOST[1:], "initialize")),
    row("Standby, Reset of the controller, v1.0: ignored", *controlled(), when=("client", Reset()),
        status=Status.STANDBY, controller="client", version=V1_0),
    row("Ready, Reset of another: ignored", *ready(), when=("rival", Reset()), status=Status.READY,
        counted=REFUSED, calls=()),
    row("Ready, ReleaseControl: Standby", *ready(), when=("client", ReleaseControl(), RELEASED),
        status=Status.STANDBY, controller="", calls=LOST),
    row("Ready, Timedout: Standby", *ready(), when=after(4.1), then={"client": [RELEASED]},
        status=Status.STANDBY, controller="", calls=LOST),
    row("Ready, preempted: stays Ready under the new controller", *ready(),
        when=("rival", RequestControl(authority_code=60)),
        then={"client": [RELEASED], "rival": [ACCEPTED]}, status=Status.READY, controller="rival",
        calls=("control lost", "controller 3.1.1")),
)  # fmt: skip

EMERGENCIES = (
    row("Standby, SetEmergency of anyone: Emergency", when=EMERGENCY, status=Status.EMERGENCY),
    row("Ready, SetEmergency of anyone: Emergency, Reject 1 to the controller", *ready(),
        when=EMERGENCY, then={"client": [REJECTED]}, status=Status.EMERGENCY, controller="",
        calls=(*LOST, "emergency True")),
    row("Ready, SetEmergency of anyone, v1.0: Emergency, Reject 0 to the controller", *ready(),
        when=EMERGENCY, then={"client": [RELEASED]}, status=Status.EMERGENCY, controller="",
        version=V1_0),
    row("Ready, SetEmergency of the controller: Emergency, Reject 1", *ready(),
        when=("client", SetEmergency(), REJECTED), status=Status.EMERGENCY),
    row("Failure, SetEmergency: Emergency", fails, when=EMERGENCY, status=Status.EMERGENCY),
    row("Shutdown, SetEmergency: Emergency", *ready(), ("client", Shutdown()), when=EMERGENCY,
        status=Status.EMERGENCY),
    row("Emergency, ClearEmergency of who set it: Standby, not controlled", *ready(), EMERGENCY,
        when=CLEARED, status=Status.STANDBY, controller="", calls=("emergency False",)),
    row("Emergency, ClearEmergency of who set it, v1.0: the state before", *ready(), EMERGENCY,
        when=CLEARED, status=Status.READY, controller="client", authority=50, version=V1_0),
    row("Emergency from Standby, ClearEmergency, v1.0: Standby, not controlled", EMERGENCY,
        when=CLEARED, status=Status.STANDBY, controller="", version=V1_0),
    row("Emergency from Failure, ClearEmergency, v1.0: Failure", fails, EMERGENCY, when=CLEARED,
        status=Status.FAILURE, version=V1_0),
    row("Emergency from Failure, ClearEmergency: Failure", fails, EMERGENCY, when=CLEARED,
        status=Status.FAILURE, controller=""),
    row("Emergency from Shutdown, ClearEmergency: Shutdown", *ready(), ("client", Shutdown()),
        EMERGENCY, when=CLEARED, status=Status.SHUTDOWN, controller=""),
    row("Emergency from Failure, set by two, ClearEmergency of both: Failure", fails, EMERGENCY,
        ("rival", SetEmergency()), ("rival", ClearEmergency()), when=CLEARED,
        status=Status.FAILURE),
    row("Failure after an emergency, RequestControl: Confirm 1", fails, EMERGENCY, CLEARED,
        when=("client", RequestControl(authority_code=255), NOT_AVAILABLE), status=Status.FAILURE),
    row("Emergency from Failure, Reset of anyone, v1.0: ignored, as in Failure", fails, EMERGENCY,
        when=("rival", Reset()), status=Status.EMERGENCY, counted="management.reset_ignored",
        version=V1_0),
    row("Emergency, ClearEmergency of another: ignored", EMERGENCY,
        when=("rival", ClearEmergency()), status=Status.EMERGENCY,
        counted="management.clear_ignored"),
    row("Emergency of two, ClearEmergency of one: Emergency", EMERGENCY, ("rival", SetEmergency()),
        when=CLEARED, status=Status.EMERGENCY),
    row("Emergency of two, ClearEmergency of one, v1.0: Emergency", EMERGENCY,
        ("rival", SetEmergency()), when=CLEARED, status=Status.EMERGENCY, version=V1_0),
    row("Emergency of two, ClearEmergency of both: Standby", EMERGENCY, ("rival", SetEmergency()),
        ("rival", ClearEmergency()), when=CLEARED, status=Status.STANDBY),
    row("Emergency set twice by one, ClearEmergency once: Standby", EMERGENCY, EMERGENCY,
        when=CLEARED, status=Status.STANDBY),
    row("Emergency, RequestControl: Confirm 1", EMERGENCY,
        when=("client", RequestControl(authority_code=255), NOT_AVAILABLE), status=Status.EMERGENCY,
        controller=""),
    row("Emergency, Shutdown of anyone, v1.0: Shutdown", EMERGENCY, when=("rival", Shutdown()),
        status=Status.SHUTDOWN, version=V1_0),
    row("Emergency, Reset of anyone, v1.0: Init", *ready(), EMERGENCY, when=("rival", Reset()),
        status=Status.STANDBY, controller="", version=V1_0),
    *(
        row(f"Emergency, {command.NAME} of the {who} before it is cleared: ignored", *ready(),
            EMERGENCY, when=(who, command()), status=Status.EMERGENCY, counted=REFUSED, calls=())
        for command in (Shutdown, Reset, Resume, Standby)
        for who in ("client", "bystander")
    ),
    row("After an emergency, control and Resume: Ready", *ready(), EMERGENCY, CLEARED,
        *controlled(), when=("client", Resume()), status=Status.READY, controller="client"),
    row("Emergency, ClearEmergency with code 0: Standby", *ready(), EMERGENCY,
        when=lambda stage: stage.peers["bystander"].send_bytes(b"\x07\x00\x00\x00",
        stage.component), status=Status.STANDBY, controller=""),
    row("Emergency, code 0 of the JAUS Tool Set: Emergency",
        when=lambda stage: stage.peers["bystander"].send_bytes(b"\x06\x00\x00\x00",
        stage.component), status=Status.EMERGENCY),
    row("Emergency, unknown code: ignored",
        when=lambda stage: stage.peers["bystander"].send_bytes(b"\x06\x00\x07\x00",
        stage.component), status=Status.STANDBY, counted="management.bad_emergency_code"),
)  # fmt: skip

FAILURES = (
    *(
        row(f"{name}, Failure: Failure", *given, when=fails, then=then, status=Status.FAILURE,
            calls=calls)
        for name, given, then, calls in (
            ("Standby", (), {}, ()),
            ("Controlled Standby", controlled(), {"client": [RELEASED]}, LOST[1:]),
            ("Ready", ready(), {"client": [RELEASED]}, LOST),
            ("Emergency", (EMERGENCY,), {}, ()),
            ("Shutdown", (*ready(), ("client", Shutdown())), {}, ()),
        )
    ),
    row("Failure, RequestControl: Confirm 1", fails, status=Status.FAILURE,
        when=("client", RequestControl(authority_code=255), NOT_AVAILABLE)),
)  # fmt: skip

QUERIES = tuple(
    row(f"{name}, QueryStatus: {value}", *given, version=version,
        when=("rival", QueryStatus(), status(value)))
    for version in ((1, 1), V1_0)
    for name, given, value in (
        (f"Standby {version}", (), 2),
        (f"Controlled Standby {version}", controlled(), 2),
        (f"Ready {version}", ready(), 1),
        (f"Shutdown {version}", (*ready(), ("client", Shutdown())), 3),
        (f"Failure {version}", (fails,), 4),
        (f"Emergency {version}", (EMERGENCY,), 5),
    )
)  # fmt: skip


@rows(*LIFE, *EMERGENCIES, *FAILURES, *QUERIES)
def test_row(world, row):
    stage = play(world, row, Robot)
    if row.given[: len(ready())] == ready() and stage.component.status is not Status.READY:
        assert stage.component.calls.count("not ready") == 1, "motion must be stopped, once"
    if row.status is Status.SHUTDOWN:
        assert stage.component.calls.count("shutdown") == 1


def test_session_of_the_jaus_tool_set(world):
    """The exchange of a published capture: v1.0, with emergency code 0."""
    exchange = (
        (RequestControl(authority_code=200), [ACCEPTED]),
        (QueryStatus(), [status(2)]),
        (Resume(), []),
        (QueryStatus(), [status(1)]),
        (b"\x06\x00\x00\x00", [RELEASED]),
        (QueryStatus(), [status(5)]),
        (b"\x07\x00\x00\x00", []),
        (QueryStatus(), [status(1)]),
        (Standby(), []),
        (ReleaseControl(), [RELEASED]),
    )
    stage = play(world, row("start", when=after(0.1), version=V1_0))
    client = stage.peers["client"]
    for sent, answers in exchange:
        payload = sent if isinstance(sent, bytes) else sent.encode()
        client.send_bytes(payload, stage.component)
        assert client.take() == answers
