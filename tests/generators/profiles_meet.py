"""The vehicle and the unit of the profiles of IOP in one virtual world: run by test_profiles.py."""

import pytest
from jausml_runtime import (
    ComponentSettings,
    ControlState,
    HandoffDecision,
    JausAddress,
    JausComponent,
)
from jausml_runtime.virtual import Link, VirtualWorld
from unit.ros_types import Odometry as UnitOdometry
from unit.ros_types import Twist as UnitTwist
from unit.unit import Unit
from vehicle.ros_types import Odometry, Twist
from vehicle.vehicle import Vehicle

VEHICLE = JausAddress(100, 1, 1)
RADIO = Link(delay=0.05, loss=0.2)


class Scene:
    """A vehicle behind a bad radio, and the unit of its operator."""

    def __init__(self, world):
        self.world = world
        self.vehicle, self.unit = Vehicle(), Unit()
        self.vehicle.open(
            world.ros_node("vehicle", namespace="vehicle"), world.transport(out=RADIO, into=RADIO)
        )
        self.unit.open(world.ros_node("unit", namespace="unit"), world.transport())
        self.twists, self.poses = [], []
        world.ros.subscribe("/vehicle/cmd_vel", Twist, self.moved)
        world.ros.subscribe("/unit/odom", UnitOdometry, self.told)

    def moved(self, data):
        self.twists.append((self.world.now(), Twist.from_cdr(data).linear.x))

    def told(self, data):
        self.poses.append(UnitOdometry.from_cdr(data).pose.pose)

    def drive(self, speed, seconds):
        """The person holds the stick."""
        for _ in range(round(seconds * 10)):
            twist = UnitTwist()
            twist.linear.x = speed
            self.world.ros.publish("/unit/cmd_vel", UnitTwist, twist.to_cdr())
            self.world.run_for(0.1)

    def close(self):
        self.unit.close()
        self.vehicle.close()


@pytest.fixture
def scene():
    with VirtualWorld(seed=1) as world:
        made = Scene(world)
        yield made
        made.close()


def test_it_is_driven_and_stops(scene):
    scene.drive(0.5, 10)
    assert scene.twists[-1][1] == pytest.approx(0.5, abs=1e-3)
    scene.world.run_for(0.2)
    silent_since = scene.world.now()
    scene.world.run_for(10)
    stopped = next(at for at, speed in scene.twists if at > silent_since - 0.2 and speed == 0)
    assert stopped < silent_since + 1.5
    assert scene.twists[-1][1] == 0


def test_it_stops_when_the_unit_is_gone(scene):
    scene.drive(0.5, 10)
    scene.unit.component.transport.cut()
    cut = scene.world.now()
    scene.world.run_for(10)
    at, speed = scene.twists[-1]
    assert speed == 0
    assert at < cut + 1.0


def test_it_tells_where_it_is(scene):
    odometry = Odometry()
    odometry.pose.pose.position.x = 3.0
    odometry.pose.pose.orientation.w = 1.0
    for _ in range(100):
        scene.world.ros.publish("/vehicle/odom", Odometry, odometry.to_cdr())
        scene.world.run_for(0.1)
    assert scene.poses[-1].position.x == pytest.approx(3.0, abs=1e-3)


def test_a_person_at_the_unit_hands_it_over(scene):
    scene.drive(0.5, 10)
    asked = []
    scene.unit.on_handoff_requested = lambda _target, requests: asked.extend(requests)
    other = JausComponent(
        scene.world.transport(),
        JausAddress(61, 1, 1),
        name="other",
        services=(),
        settings=ComponentSettings(register_services=False),
    )
    other.start()
    session = other.control(VEHICLE, authority=50)
    other.request_handoff(VEHICLE, authority=50, explanation="end of shift")
    scene.drive(0.5, 10)
    assert (len(asked), scene.twists[-1][1]) == (1, pytest.approx(0.5, abs=1e-3))
    scene.unit.decide_handoff(asked[0], HandoffDecision.GRANTED)
    granted = scene.world.now()
    scene.drive(0.5, 20)  # the stick is held on, and moves nothing any more
    assert session.state is ControlState.READY
    assert scene.vehicle.component.controller == other.address
    moving = [at for at, speed in scene.twists if speed != 0]
    assert moving[-1] < granted + 1.0
    assert scene.twists[-1][1] == 0
    other.stop()
