"""A running system is recorded, and its recording says why a message was not passed on."""

import needs
import pytest

needs.ask("rclpy")

from jausml.language.model import read_models
from jausml.live.systems.explaining import explained

from .bridge_support import MODEL, Repeater, System, generate, wait_for
from .recorder import PATIENCE, Recorder

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.ports]
VEHICLE = str(MODEL.parents[2] / "live" / "bridge_vehicle.py")
BRIDGE = "/loop_bridge"


def twist(effort):
    from geometry_msgs.msg import Twist

    message = Twist()
    message.linear.x = effort
    return message


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording in which a vehicle is driven, then with an effort that no field can carry."""
    folder = tmp_path_factory.mktemp("playback")
    with System(generate(), folder) as system, Recorder(folder, MODEL, system.port) as recorder:
        system.start("-m", "loop_bridge.main")
        vehicle = system.start(VEHICLE, "--address", "10.1.1")
        publisher = system.ros.publisher(type(twist(0.0)), "cmd_vel")
        wait_for(lambda: publisher.get_subscription_count() > 1, "recorder of ROS", PATIENCE)
        with Repeater(publisher, twist(2.0)):
            wait_for(lambda: len(vehicle.of_kind("effort")) > 40, "efforts", PATIENCE)
            publisher.publish(twist(50.0))
            obeyed = len(vehicle.of_kind("effort"))
            wait_for(lambda: len(vehicle.of_kind("effort")) > obeyed + 60, "efforts", PATIENCE)
        return recorder.end()


@pytest.fixture(scope="module")
def model():
    return read_models([MODEL], allow_outside=True).model


def test_a_drop_is_explained_by_counter_and_state(recorded, model):
    (drop,) = [
        mark
        for mark in recorded.marks
        if mark.subject == (BRIDGE, "drive") and mark.counter == "out_of_range"
    ]
    found = explained(recorded, model, (BRIDGE, "drive"), drop.time)
    span = f"{drop.since:.1f} s and {drop.time:.1f} s"
    assert found.counter[:2] == (
        f"Between {span}, loop_bridge drive did not pass on 1 message: its counter "
        "\u201cout_of_range\u201d rose from 0 to 1.",
        "A message is counted there because a value did not fit its field, and the map drops such "
        "a message.",
    )
    assert found.state[:3] == (
        f"At {drop.time:.1f} s, the connection was failed: values out of range.",
        "The bridge 10.1.9 was active and in STANDBY, controlled by nobody.",
        "To the bridge, its peer 10.1.1 was ready; it was in READY, controlled by 10.1.9.",
    )
    assert "Its value PropulsiveLinearEffortX was out of range 1 time (error)." in found.state


def test_rates_and_controllers_are_those_of_the_live_view(recorded, model):
    state = recorded.state(recorded.duration, model)
    assert state.sources == {"ROS": "", "JAUS": ""}
    odometry = state.connections[BRIDGE, "odometry"]
    assert odometry.declaration is not None
    assert odometry.rate is not None
    assert odometry.rate > 0.0
    assert state.components["10.1.1"].controller == "10.1.9"
    assert recorded.unreadable == 0
