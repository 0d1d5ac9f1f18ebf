"""The patterns of drivers and sensors, row by row (AS6009), with messages of their kinds."""

from dataclasses import dataclass

import pytest

from jausml.runtime import Guard, JausComponent, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import QueryAuthority, ReportAuthority, Resume, SetAuthority

from .state_tables import Row, after, controlled, play, ready, rows, unavailable

REFUSED = "component.command_refused"
ASKER = JausAddress(9, 9, 9)
CURRENT, MAXIMUM, MINIMUM, DEFAULT = range(4)


@dataclass(slots=True)
class SetVelocityCommand(SetAuthority):
    """Its field stands for the CommandType: a limit is legal in Standby, the current one not."""

    CODE = 0x0415
    NAME = "SetVelocityCommand"


@dataclass(slots=True)
class SetWrenchEffort(SetAuthority):
    """A command of a driver: Ready alone."""

    CODE = 0x0405
    NAME = "SetWrenchEffort"


@dataclass(slots=True)
class SetGlobalWaypoint(SetAuthority):
    """A command of a driver that may prepare a drive: Standby and Ready."""

    CODE = 0x040C
    NAME = "SetGlobalWaypoint"


@dataclass(slots=True)
class SetLocalPose(SetAuthority):
    """A command of a sensor that has AccessControl: whenever controlled."""

    CODE = 0x0403
    NAME = "SetLocalPose"


@dataclass(slots=True)
class QueryVelocityState(QueryAuthority):
    """A query of a sensor: in any state."""

    CODE = 0x2404
    NAME = "QueryVelocityState"


@dataclass(slots=True)
class ReportVelocityState(ReportAuthority):
    """The report that answers it."""

    CODE = 0x4404
    NAME = "ReportVelocityState"


def guard_of(message):
    return Guard.READY if message.authority_code == CURRENT else Guard.CONTROLLED


class Robot(JausComponent):
    """A driver and a sensor."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.obeyed = []
        self.stops = 0
        self.handle(SetVelocityCommand, self.obey, when=guard_of)
        self.handle(SetWrenchEffort, self.obey, when=Guard.READY)
        self.handle(SetGlobalWaypoint, self.obey, when=Guard.CONTROLLED)
        self.handle(SetLocalPose, self.obey, when=Guard.CONTROLLED)
        self.provide(
            QueryVelocityState, ReportVelocityState, lambda _query, _sender: ReportVelocityState(7)
        )

    def obey(self, message, _sender):
        self.obeyed.append(message)

    def on_not_ready(self):
        self.stops += 1


def fails(stage):
    stage.component.fail("a motor is broken")


SITUATIONS = {
    "NotControlled": ((), "client"),
    "Standby": (controlled(), "client"),
    "Ready": (ready(), "client"),
    "Ready, another's": (ready(), "rival"),
    "Ready, unavailable": ((*ready(), unavailable), "client"),
    "Failure": ((*ready(), fails), "client"),
    "Timed out": ((*ready(), after(5.1)), "client"),
}

COMMANDS = {
    "driver, Set: Ready": (SetWrenchEffort(), {"Ready", "Ready, unavailable"}),
    "driver, waypoint: Controlled": (SetGlobalWaypoint(),
        {"Standby", "Ready", "Ready, unavailable"}),
    "sensor, Set...Pose: Controlled": (SetLocalPose(), {"Standby", "Ready", "Ready, unavailable"}),
    "VelocityStateDriver, current command: Ready": (SetVelocityCommand(CURRENT),
        {"Ready", "Ready, unavailable"}),
    "VelocityStateDriver, maximum: Controlled": (SetVelocityCommand(MAXIMUM),
        {"Standby", "Ready", "Ready, unavailable"}),
    "VelocityStateDriver, minimum: Controlled": (SetVelocityCommand(MINIMUM),
        {"Standby", "Ready", "Ready, unavailable"}),
    "VelocityStateDriver, default: Controlled": (SetVelocityCommand(DEFAULT),
        {"Standby", "Ready", "Ready, unavailable"}),
}  # fmt: skip


@rows(
    *(
        Row(
            f"{name}; {situation}: {'obeyed' if situation in legal else 'ignored'}",
            given,
            when=(sender, message),
            counted="" if situation in legal else REFUSED,
        )
        for name, (message, legal) in COMMANDS.items()
        for situation, (given, sender) in SITUATIONS.items()
    )
)
def test_command(world, row):
    stage = play(world, row, Robot)
    assert stage.component.obeyed == ([] if row.counted else [row.when[1]])


@rows(
    *(Row(f"Query; {situation}: answered", given) for situation, (given, _) in SITUATIONS.items())
)
def test_query(world, row):
    stage = play(world, row, Robot)
    answers = []
    stage.component.transport.attach(
        ASKER, lambda payload, _: answers.append(ReportVelocityState.decode(payload))
    )
    world.send(ASKER, stage.component.address, QueryVelocityState().encode())
    world.settle()
    assert answers == [ReportVelocityState(7)]


def test_leaving_ready_stops_motion_each_time(world):
    stage = play(world, Row("start", ready(), status=Status.READY), Robot)
    for stops in range(1, 4):
        stage.component.fail("again") if stops == 3 else world.run(5.1, step=0.5)
        assert stage.component.stops == stops
        for step in ready():
            stage.do(step)


def test_guard_that_raises_refuses_and_is_counted(world):
    component = world.component("1.1.1")

    def guard(_message):
        raise RuntimeError("no idea")

    component.handle(SetWrenchEffort, lambda *_: pytest.fail("obeyed"), when=guard)
    component.start()
    world.probe("2.1.1").tell(component, SetWrenchEffort())
    assert world.counters.snapshot()["component.handler_failed"] == 1


def test_guard_of_a_message_that_cannot_be_decoded(world):
    component = world.component("1.1.1")
    component.handle(Resume2, lambda *_: pytest.fail("obeyed"), when=lambda _message: Guard.ANY)
    component.start()
    world.probe("2.1.1").send_bytes(Resume2().encode() + b"\0", component)
    world.settle()
    assert world.counters.snapshot()["component.bad_message"] == 1


class Resume2(Resume):
    """A message without fields."""

    CODE = 0x1F02
    NAME = "Resume2"
