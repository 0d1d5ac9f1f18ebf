"""Stories of a robot and its operators, on a clock that the test turns: who moves it, and when."""

import pytest

from jausml.runtime import Completion, ControlState, Guard, JausComponent, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ClearEmergency, RequestControl, SetAuthority, SetEmergency
from jausml.runtime.services.management import MAX_EMERGENCY_CLIENTS

ROBOT = JausAddress(1, 1, 1)
FIRST, SECOND, THIRD = (JausAddress(subsystem, 1, 1) for subsystem in (2, 3, 4))


class Drive(SetAuthority):
    """A command that moves the robot; its field is the speed."""

    CODE = 0x0405
    NAME = "Drive"


class Robot(JausComponent):
    """Moves at the speed it was told, as long as it is Ready."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.speed = 0
        self.stops = []
        self.controllers = []
        self.emergencies = []
        self.completion = None
        self.handle(Drive, self.on_drive, when=Guard.READY)

    def on_drive(self, message, _sender):
        self.speed = message.authority_code
        self.completion = Completion()
        return self.completion

    def on_not_ready(self):
        self.speed = 0
        self.stops.append(self.loop.now())

    def on_controller_changed(self, controller):
        self.controllers.append(controller)

    def on_emergency(self, active):
        self.emergencies.append(active)


@pytest.fixture
def robot(world):
    return world.started(str(ROBOT), kind=Robot, control_timeout=4, default_authority=5)


def operator(world, address):
    return world.started(str(address), services=())


def counted(world, name):
    return world.counters.snapshot().get(name, 0)


def test_operators_of_different_authority_take_turns(world, robot):
    first, second = operator(world, FIRST), operator(world, SECOND)
    low = first.control(ROBOT, authority=50)
    world.run(1.0, step=0.1)
    first.send(Drive(7), ROBOT)
    world.settle()
    assert robot.speed == 7
    high = second.control(ROBOT, authority=60)
    world.run(1.0, step=0.1)
    assert (low.state, high.state) == (ControlState.REFUSED, ControlState.READY)
    assert robot.status is Status.READY, "who preempts takes the robot over as it moves"
    first.send(Drive(9), ROBOT)
    world.settle()
    assert robot.speed == 7
    assert counted(world, "component.command_refused") == 1
    high.release()
    world.settle()
    assert robot.speed == 0
    world.run(10.0, step=0.1)
    assert low.state is ControlState.READY
    assert robot.controllers == [FIRST, SECOND, None, FIRST]


def test_controller_that_lowers_its_authority_lets_others_in(world, robot):
    first, second = world.probe(str(FIRST)), world.probe(str(SECOND))
    first.ask(RequestControl(authority_code=200), robot)
    (refusal,) = second.ask(RequestControl(authority_code=100), robot)
    assert refusal.response_code == 2
    first.ask(SetAuthority(authority_code=99), robot)
    (grant,) = second.ask(RequestControl(authority_code=100), robot)
    assert grant.response_code == 0
    assert robot.controllers == [FIRST, SECOND]


@pytest.mark.parametrize("dead_after", [0.0, 1.7, 3.3])
def test_robot_stops_when_its_operator_dies(world, robot, dead_after):
    first = operator(world, FIRST)
    first.control(ROBOT, authority=50)
    world.run(1.0, step=0.1)
    first.send(Drive(7), ROBOT)
    world.run(dead_after, step=0.1)
    died = world.time
    world.lost = lambda source, _destination, _code: source == FIRST
    world.run(10.0, step=0.1)
    assert robot.speed == 0
    assert died + 2.0 <= robot.stops[0] <= died + 4.1
    assert counted(world, "access_control.timed_out") == 1


def test_operator_that_comes_back_goes_on(world, robot):
    first = operator(world, FIRST)
    session = first.control(ROBOT, authority=50)
    world.run(1.0, step=0.1)
    world.lost = lambda *_: True
    world.run(20.0, step=0.1)
    assert session.state is ControlState.SEEKING
    world.lost = lambda *_: False
    world.run(10.0, step=0.1)
    assert session.state is ControlState.READY
    assert robot.controllers == [FIRST, None, FIRST]


def test_emergency_of_two_bystanders(world, robot):
    first = operator(world, FIRST)
    session = first.control(ROBOT, authority=50)
    ends = []
    world.run(1.0, step=0.1)
    first.command(ROBOT, Drive(7), on_done=ends.append)
    world.settle()
    assert robot.speed == 7
    second, third = operator(world, SECOND), operator(world, THIRD)
    second.set_emergency(ROBOT)
    world.settle()
    assert (robot.speed, robot.status, robot.controller) == (0, Status.EMERGENCY, None)
    assert ends == [False]
    third.set_emergency(ROBOT)
    world.run(20.0, step=0.25)
    assert session.state is ControlState.REFUSED
    first.send(Drive(9), ROBOT)
    first.clear_emergency(ROBOT)
    second.clear_emergency(ROBOT)
    world.run(20.0, step=0.25)
    assert (robot.speed, robot.status) == (0, Status.EMERGENCY)
    assert counted(world, "management.clear_ignored") == 1
    third.clear_emergency(ROBOT)
    world.settle()  # an event tells the operator, who takes control again
    assert session.state is ControlState.READY
    assert robot.speed == 0, "nobody has told it to move again"
    assert robot.emergencies == [True, False]


def test_flood_of_emergencies_is_bounded_and_safe(world, robot):
    flood = [JausAddress(100 + number // 200, 1, 1 + number % 200) for number in range(1200)]
    for address in flood:
        world.send(address, ROBOT, SetEmergency().encode())
    world.settle()
    assert len(robot._jaus_management._emergencies) == MAX_EMERGENCY_CLIENTS
    for address in flood[: MAX_EMERGENCY_CLIENTS - 1]:
        world.send(address, ROBOT, ClearEmergency().encode())
    world.settle()
    assert robot.status is Status.EMERGENCY


def test_control_that_is_not_offered(world, robot):
    first = operator(world, FIRST)
    robot.control_available = False
    session = first.control(ROBOT, authority=50)
    world.run(5.0, step=0.25)
    assert session.state is ControlState.REFUSED
    robot.control_available = True
    world.run(10.0, step=0.25)
    assert session.state is ControlState.READY
