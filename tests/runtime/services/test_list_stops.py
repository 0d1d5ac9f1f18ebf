"""Lists that a bridge has a peer execute, and that are stopped while the radio is away."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

import pytest

from jausml.runtime import JausComponent, ServiceIdentity, Status
from jausml.runtime.bridge.ends.actions import ListAction, Outcome
from jausml.runtime.bridge.ends.list_driver import ListMessages
from jausml.runtime.bridge.lists.action_to_list import ActionToList
from jausml.runtime.messages import (
    ConfirmElementRequest,
    DeleteElement,
    RequestControl,
    Resume,
    SetElement,
    Standby,
)
from jausml.runtime.services.definitions import Guard
from jausml.runtime.wire.message import Message

from .bridge_support import CORE, OWN, PEER, Number, Ros, Setting, number_to_time

SERVICES = (*CORE, ServiceIdentity("urn:jaus:jss:core:ListManager", 1, 1))
DRIVER_CODES = (0x041E, 0x241E, 0x441E)
"""ExecuteList, and the query and the report of the active element."""


@dataclass
class Told(Message):
    """A message of two numbers, as far as this driver needs them."""

    element_uid: int = 0
    speed: float = 0.0

    NAME: ClassVar[str] = "Told"

    def encode(self) -> bytes:
        return b"".join(
            (self.CODE.to_bytes(2, "little"), self.element_uid.to_bytes(2, "little"))
        ) + int(self.speed * 10).to_bytes(2, "little")

    @classmethod
    def decode(cls, data):
        uid, speed = (int.from_bytes(data[at : at + 2], "little") for at in (2, 4))
        return cls(uid, speed / 10)


@dataclass
class ExecuteList(Told):
    """Begins at an element; without one it changes the speed."""

    CODE = DRIVER_CODES[0]


@dataclass
class QueryActiveElement(Told):
    """Asks."""

    CODE = DRIVER_CODES[1]


@dataclass
class ReportActiveElement(Told):
    """Answers."""

    CODE = DRIVER_CODES[2]


DRIVER = ListMessages(ExecuteList, QueryActiveElement, ReportActiveElement)
ACTION = ListAction("test_msgs/action/Follow", "follow", Number, "poses")


class Vehicle(JausComponent):
    """Follows its list until it has none, at the speed that it was told last."""

    speed = 0.0
    active = 0

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.handle(ExecuteList, self._execute, when=Guard.READY)
        self.provide(QueryActiveElement, ReportActiveElement, self._report)

    def supports_element(self, _element):
        return True

    def _execute(self, message, _sender):
        self.speed = message.speed
        self.active = message.element_uid or self.active

    def _report(self, _query, _sender):
        return ReportActiveElement(self.active)

    @property
    def drives(self):
        return self.speed > 0 and bool(self.elements) and self.status is Status.READY


@dataclass
class Goal:
    """A goal of a ROS client."""

    request: Any = None
    ends: list[tuple[Outcome, str]] = field(default_factory=list)

    def progress(self, number):
        del number

    def end(self, outcome, reason=""):
        self.ends.append((outcome, reason))


class ActionRos(Ros):
    """Has actions besides; goals go to the last one."""

    def __init__(self):
        super().__init__()
        self.takers = []

    def serve_action(self, _action, taker):
        self.takers.append(taker)

    @property
    def taker(self):
        return self.takers[-1]

    def accepts(self, *numbers):
        return self.taker.accepts([Number(number).to_cdr() for number in numbers], None)

    def begin(self):
        goal = Goal()
        self.taker.begin(goal)
        return goal

    def send(self, *numbers):
        assert self.accepts(*numbers)
        return self.begin()


@pytest.fixture
def setting(world):
    made = Setting(world, ActionRos())
    yield made
    made.bridge.close()


def opened(world, setting, *, control_timeout=0, services=(), names=("follow",), **options):
    """A bridge that has a vehicle drive along a list; the vehicle."""
    vehicle = world.started(
        str(PEER), kind=Vehicle, services=SERVICES, control_timeout=control_timeout
    )
    common = {"action": ACTION, "driver": DRIVER, "peers": [PEER], "speed": 1.0, **options}
    connections = [ActionToList(name, number_to_time, **common) for name in names]
    setting.open(*connections, services=services)
    world.run(0.5)
    return vehicle


def begun(world, setting, vehicle, *numbers):
    """A goal that the vehicle follows."""
    goal = setting.ros.send(*(numbers or (1.0, 2.0)))
    world.run(0.5)
    assert vehicle.drives
    return goal


@pytest.fixture
def driving(world, setting):
    """A vehicle and the goal that it follows."""
    vehicle = opened(world, setting)
    return vehicle, begun(world, setting, vehicle)


def away(world, *codes):
    """Loses all that goes to the vehicle, or some of it; returns what ends that."""
    before = world.lost
    world.lost = lambda _source, to, code: to == PEER and (not codes or code in codes)
    return lambda: setattr(world, "lost", before)


def deletions(world):
    return world.count(DeleteElement.CODE)


def test_a_goal_that_is_canceled_while_the_radio_is_away_stops_the_vehicle(world, setting, driving):
    vehicle, goal = driving
    restore = away(world)
    setting.ros.taker.cancel(goal)
    world.run(2.0)
    ((outcome, reason),) = goal.ends
    assert outcome is Outcome.ABORTED
    assert "should have stopped and did not confirm it" in reason
    restore()
    world.run(3.0)
    assert not vehicle.drives
    assert (vehicle.speed, list(vehicle.elements)) == (0.0, [])
    before = deletions(world)
    world.run(20.0)
    assert deletions(world) == before


def test_a_vehicle_that_was_silent_for_a_while_is_stopped(world, driving):
    vehicle, goal = driving
    restore = away(world)
    world.run(3.8)
    assert goal.ends == [(Outcome.ABORTED, f"{PEER} is silent")]
    restore()
    world.run(3.0)
    assert not vehicle.drives


@pytest.mark.parametrize("code", [ExecuteList.CODE, DeleteElement.CODE])
def test_half_a_stop_is_no_stop(world, setting, driving, code):
    vehicle, goal = driving
    restore = away(world, code)
    setting.ros.taker.cancel(goal)
    world.run(2.0)
    restore()
    world.run(3.0)
    assert (vehicle.speed, list(vehicle.elements)) == (0.0, [])


def test_a_vehicle_that_obeys_again_does_not_go_on(world, driving):
    vehicle, goal = driving
    restore = away(world)
    world.run(30.0)  # the bridge takes control for lost; the vehicle does not mind
    assert goal.ends
    assert vehicle.drives
    restore()
    world.run(10.0)
    assert not vehicle.drives


def test_a_list_that_another_should_have_replaced_is_stopped(world, setting, driving):
    vehicle, first = driving
    restore = away(world, SetElement.CODE, DeleteElement.CODE)
    second = setting.ros.send(3.0)
    world.run(2.5)
    assert [goal.ends[0][0] for goal in (first, second)] == [Outcome.ABORTED] * 2
    restore()
    world.run(4.0)
    assert not vehicle.drives


def test_a_stop_is_not_sent_after_the_next_goal(world, setting, driving):
    vehicle, goal = driving
    restore = away(world)
    setting.ros.taker.cancel(goal)
    world.run(1.2)
    restore()
    following = setting.ros.send(5.0, 6.0, 7.0)
    world.run(1.5)
    stops = deletions(world)
    world.run(10.0)
    assert vehicle.drives
    assert following.ends == []
    assert deletions(world) == stops


def test_a_stop_that_arrived_is_not_repeated(world, setting, driving):
    vehicle, goal = driving
    before = deletions(world)
    setting.ros.taker.cancel(goal)
    world.run(10.0)
    assert goal.ends == [(Outcome.CANCELED, "canceled")]
    assert not vehicle.drives
    assert deletions(world) == before + 1
    assert world.count(ConfirmElementRequest.CODE) > before


def test_a_stop_is_not_repeated_when_the_bridge_has_ended(world, setting, driving):
    _, goal = driving
    away(world)
    setting.ros.taker.cancel(goal)
    world.run(2.5)
    setting.bridge.close()
    before = deletions(world)
    world.run(20.0)
    assert deletions(world) == before


def test_a_list_that_was_driven_to_its_end_is_not_stopped(world, driving):
    vehicle, goal = driving
    vehicle.active = list(vehicle.elements)[-1].uid
    world.run(1.5)
    vehicle.active = 0
    world.run(1.5)
    assert goal.ends == [(Outcome.SUCCEEDED, "")]
    before = deletions(world)
    restore = away(world)
    world.run(30.0)
    restore()
    world.run(10.0)
    assert deletions(world) == before


def test_a_goal_of_another_action_takes_the_place_of_one_at_the_same_peer(world, setting):
    vehicle = opened(world, setting, names=("follow", "other"))
    goal = begun(world, setting, vehicle)
    setting.ros.takers.reverse()
    following = begun(world, setting, vehicle, 3.0, 4.0)
    for uid in (*(element.uid for element in vehicle.elements), 0):
        vehicle.active = uid
        world.run(1.5)
    # Its list had as many elements, and none of them was executed.
    assert goal.ends == [(Outcome.ABORTED, "another goal took its place")]
    assert following.ends == [(Outcome.SUCCEEDED, "")]


def test_a_question_about_a_list_that_is_done_stops_no_other(world, setting, driving):
    """Its last repetition is lost, and the next list is set before that is known."""
    vehicle, goal = driving
    restore = away(world, QueryActiveElement.CODE)
    world.run(1.35)
    for uid in (list(vehicle.elements)[-1].uid, 0):
        vehicle.active = uid
        vehicle.report_changed(ReportActiveElement)
        world.run(0.02)
    assert goal.ends == [(Outcome.SUCCEEDED, "")]
    following = setting.ros.send(3.0)
    world.run(0.3)
    restore()
    world.run(3.0)
    assert following.ends == []
    assert vehicle.drives


class TestBetweenAcceptanceAndBeginning:
    """The lock of the loop is free then, and anything may happen."""

    @pytest.fixture
    def operator(self, world):
        return world.probe("7.1.1", strict=False)

    @pytest.fixture
    def vehicle(self, world, setting, operator):
        vehicle = opened(world, setting, services=CORE)
        operator.send(RequestControl(authority_code=100), OWN)
        operator.send(Resume(), OWN)
        world.run(2.0)
        assert setting.ros.accepts(1.0)
        return vehicle

    @pytest.mark.parametrize("is_resumed", [False, True])
    def test_a_goal_is_not_begun_once_the_bridge_was_stopped(
        self, world, setting, operator, vehicle, is_resumed
    ):
        operator.send(Standby(), OWN)
        if is_resumed:
            operator.send(Resume(), OWN)
        world.settle()
        goal = setting.ros.begin()
        world.run(1.0)
        assert not vehicle.drives
        assert [outcome for outcome, _ in goal.ends] == [Outcome.ABORTED]
        assert world.counters.snapshot()["bridge.follow.not_ready"] == 1

    def test_a_goal_is_not_begun_when_the_vehicle_obeys_no_more(self, world, setting, vehicle):
        rival = world.probe("8.1.1", strict=False)
        rival.tell(PEER, RequestControl(authority_code=255))
        goal = setting.ros.begin()
        assert [outcome for outcome, _ in goal.ends] == [Outcome.ABORTED]
        world.run(1.0)
        assert not vehicle.drives

    def test_a_goal_is_begun_else(self, world, setting, vehicle):
        goal = setting.ros.begin()
        world.run(1.0)
        assert vehicle.drives
        assert goal.ends == []
