"""The core services between two transports on loopback: real datagrams and acknowledgements."""

import threading
import time
from itertools import pairwise
from statistics import median

import pytest

from jausml.runtime import (
    Completion,
    ComponentSettings,
    ControlState,
    Guard,
    JausComponent,
    ServiceIdentity,
    Status,
    chain,
)
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import (
    QueryHeartbeatPulse,
    QueryTime,
    ReportHeartbeatPulse,
    ReportTime,
    SetAuthority,
)

from ..conftest import wait_until
from .state_tables import CORE_NAMES, V1_1, core_services

pytestmark = pytest.mark.ports

ROBOT, OPERATOR = JausAddress(1, 1, 1), JausAddress(2, 1, 1)
SERVICES = (
    *core_services(V1_1, *CORE_NAMES),
    ServiceIdentity("urn:jaus:jss:core:ListManager", 1, 1),
    ServiceIdentity("urn:jaus:jss:mobility:GlobalWaypointListDriver", 1, 0),
)


class Drive(SetAuthority):
    """A command that takes time."""

    CODE = 0x1F00
    NAME = "Drive"


class Robot(JausComponent):
    """Drives until it is told that it has arrived."""

    def __init__(self, transport):
        super().__init__(transport, ROBOT, name="robot", services=SERVICES)
        self.drive = None
        self.handle(Drive, self.on_drive, when=Guard.READY)

    def on_drive(self, _message, _sender):
        self.drive = Completion()
        return self.drive


@pytest.fixture
def robot(station):
    component = Robot(station().transport)
    component.start()
    yield component
    component.stop()


@pytest.fixture
def operator(station):
    component = JausComponent(
        station().transport,
        OPERATOR,
        name="operator",
        services=(),
        settings=ComponentSettings(retry_min=0.05),
    )
    component.start()
    yield component
    component.stop()


def test_list_command_time_and_emergency(robot, operator):
    session = operator.control(ROBOT, authority=100)
    wait_until(lambda: session.state is ControlState.READY)

    listed = threading.Event()
    waypoints = chain(((uid, b"\x0c\x04" + bytes(60), 0) for uid in range(1, 301)), circular=True)
    operator.set_list(ROBOT, waypoints, on_done=listed.set)
    assert listed.wait(10)
    assert list(robot.elements) == waypoints

    ends = []
    operator.command(ROBOT, Drive(), on_done=ends.append)
    wait_until(lambda: robot.drive is not None)
    robot.drive.succeed()
    wait_until(lambda: ends == [True])

    times = []
    operator.query(
        ROBOT, QueryTime(presence_vector=3), ReportTime, lambda report, _: times.append(report)
    )
    wait_until(lambda: times)
    assert times[0].date_stamp.year + 2000 == robot.current_time.year

    operator.command(ROBOT, Drive(), on_done=ends.append)
    wait_until(lambda: robot.drive.active)
    operator.set_emergency(ROBOT)
    wait_until(lambda: robot.status is Status.EMERGENCY)
    wait_until(lambda: ends == [True, False])
    operator.clear_emergency(ROBOT)
    wait_until(lambda: robot.status is not Status.EMERGENCY)


@pytest.mark.parametrize("rate", [200.0, 1000.0])
def test_events_are_as_fast_as_they_are_asked_for(robot, operator, rate):
    """A provider that gave 100 Hz at most would have 10 ms between two reports."""
    times = []
    operator.subscribe(
        robot.address,
        QueryHeartbeatPulse(),
        ReportHeartbeatPulse,
        lambda *_: times.append(time.monotonic()),
        rate=rate,
    )
    wait_until(lambda: len(times) > 500, 30.0)
    assert median(b - a for a, b in pairwise(times)) < 0.009
