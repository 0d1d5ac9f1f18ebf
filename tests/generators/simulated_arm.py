"""What the component arm does straight from the generator: run by test_simulated.py."""

import logging

import pytest
from arm.arm import Arm
from arm.messages import (
    ExecuteList,
    QueryAckermannConfiguration,
    QueryActiveElement,
    QueryCommandedPanTiltJointPositions,
    QueryLocalPose,
    QueryVelocityState,
    ReportAckermannConfiguration,
    ReportActiveElement,
    ReportCommandedPanTiltJointPositions,
    ReportLocalPose,
    ReportVelocityState,
    SetAckermannConfiguration,
    SetLocalPose,
    SetPanTiltJointPositions,
)
from jausml_runtime import JausAddress, JausComponent
from jausml_runtime.virtual import VirtualWorld

ALL = 0xFFFF
LOCAL_POSE = QueryLocalPose(presence_vector=ALL)


class Operator:
    """Another component, which controls the arm and asks it."""

    def __init__(self, world, arm):
        self.world, self.arm = world, arm
        self.me = JausComponent(
            world.transport(), JausAddress(200, 1, 1), name="operator", services=()
        )
        self.me.start()
        self.me.control(arm.address, authority=200)
        world.run_until(lambda: arm.status.name == "READY", limit=30)

    def tell(self, command):
        self.me.send(command, self.arm.address)
        self.world.run_for(0.2)

    def ask(self, query, report):
        heard = []
        self.me.query(self.arm.address, query, report, lambda told, _: heard.append(told))
        self.world.run_until(lambda: heard, limit=10)
        return heard[0]

    def watch(self, query, report):
        heard = []
        self.me.subscribe(self.arm.address, query, report, lambda told, _: heard.append(told))
        self.world.run_until(lambda: heard, limit=10)
        return heard


@pytest.fixture
def operator():
    with VirtualWorld(seed=1) as world:
        arm = Arm(world.transport())
        arm.start()
        yield Operator(world, arm)


def test_at_rest_all_that_is_asked_for_is_told(operator):
    told = operator.ask(QueryVelocityState(presence_vector=ALL), ReportVelocityState)
    assert (told.velocity_x, told.yaw_rate) == pytest.approx((0, 0), abs=1e-3)
    assert told.time_stamp is not None
    some = operator.ask(QueryVelocityState(presence_vector=1), ReportVelocityState)
    assert (some.velocity_y, some.time_stamp) == (None, None)


def test_what_is_set_is_reported(operator):
    operator.tell(SetLocalPose(x=3.0, y=-2.0, yaw=0.5))
    operator.tell(SetLocalPose(x=4.0))
    told = operator.ask(LOCAL_POSE, ReportLocalPose)
    assert (told.x, told.y, told.yaw) == pytest.approx((4, -2, 0.5), abs=1e-3)
    assert operator.arm.counters.snapshot()["component.simulated"] == 1


def test_what_is_commanded_of_a_quantity_is_reported_too(operator):
    operator.tell(SetPanTiltJointPositions(joint1_position=0.25, joint2_position=-0.5))
    told = operator.ask(QueryCommandedPanTiltJointPositions(), ReportCommandedPanTiltJointPositions)
    assert (told.joint1_position, told.joint2_position) == pytest.approx((0.25, -0.5), abs=1e-3)


def test_members_that_mean_something_else_are_not_taken_over(operator):
    operator.tell(SetAckermannConfiguration(steering_angle=0.5, max_steering_rate=1.0))
    told = operator.ask(QueryAckermannConfiguration(), ReportAckermannConfiguration)
    assert (told.steering_angle, told.steering_rate) == pytest.approx((0.5, 0), abs=1e-3)


def test_an_executed_list_has_its_active_element(operator):
    assert operator.ask(QueryActiveElement(), ReportActiveElement).element_uid == 0
    operator.tell(ExecuteList(speed=1.0, element_uid=7))
    assert operator.ask(QueryActiveElement(), ReportActiveElement).element_uid == 7


def test_events_are_sent_when_something_is_set(operator):
    heard = operator.watch(LOCAL_POSE, ReportLocalPose)
    operator.tell(SetLocalPose(x=8.0))
    assert heard[-1].x == pytest.approx(8, abs=1e-3)


def test_it_says_that_it_is_simulated(caplog):
    with VirtualWorld(seed=1) as world, caplog.at_level(logging.WARNING):
        Arm(world.transport()).start()
    assert "100.1.5 is simulated" in caplog.text


def test_one_method_takes_the_place_of_the_simulation():
    class Written(Arm):
        def report_local_pose(self, *_):
            return ReportLocalPose(x=1.0)

    with VirtualWorld(seed=1) as world:
        arm = Written(world.transport())
        arm.start()
        operator = Operator(world, arm)
        operator.tell(SetLocalPose(x=5.0))
        assert operator.ask(LOCAL_POSE, ReportLocalPose).x == pytest.approx(1, abs=1e-3)
