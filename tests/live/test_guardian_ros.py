"""A guardian of a bridge whose topics and goals ROS refuses in part: it stops all others."""

import time
from pathlib import Path
from types import SimpleNamespace

import needs
import pytest

needs.ask("rclpy")

from action_msgs.srv import CancelGoal
from rclpy.serialization import serialize_message
from std_msgs.msg import Float64

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.guardian import Guardian
from jausml.runtime.guardian.rcl import loaded_libraries

from .bridge_support import PATIENCE, wait_for

pytestmark = pytest.mark.live

SERVICE = "follow/_action/cancel_goal"
QOS = {
    "history": "keep_last",
    "depth": 1,
    "reliability": "reliable",
    "durability": "volatile",
    "liveliness": "automatic",
    "deadline": 0.0,
    "lease_duration": 0.0,
}


@pytest.fixture
def turned():
    """A loop that only the test turns."""
    with Loop() as made:
        yield made


@pytest.fixture
def ward(turned):
    made = Guardian(turned, SimpleNamespace(is_simulated=False), [], lambda: None)
    yield made
    made.close()


def stop_of(topic, library):
    data = bytes(serialize_message(Float64(data=0.0))).hex()
    content = {"topic": topic, "type": "std_msgs/msg/Float64", "library": library}
    return {**content, "qos": QOS, "data": data, "stamps": []}


def test_what_ros_refuses_keeps_no_other_topic_or_goal_from_being_stopped(
    peer, turned, ward, capfd
):
    heard, asked = peer.listen(Float64, "drive"), []

    def cancel(request, response):
        asked.append(bytes(request.goal_info.goal_id.uuid))
        return response

    peer.node.create_service(CancelGoal, SERVICE, cancel)
    library = loaded_libraries()["libstd_msgs__rosidl_typesupport_c.so"]
    absent = str(Path(library).with_name("libabsent.so"))
    topics = [stop_of("absent", absent), stop_of("no topic", library), stop_of("/drive", library)]
    for goal, service in ((bytes(16), "no service"), (bytes(range(16)), f"/{SERVICE}")):
        ward.guard_goal(goal, service)
    stops = {"patience": 0.5, "topics": topics, "datagrams": []}
    ward.guard(lambda: stops).arm(True)
    end = time.monotonic() + PATIENCE
    while "1 refused by ROS" not in ward.failure:
        assert time.monotonic() < end, ward.failure
        turned.run_once(0.05)
    # From here on the loop stands still.
    wait_for(lambda: heard, "the stop of the topic that is left")
    wait_for(lambda: asked, "cancellation of the goal that is left")
    assert {message.data for message in heard} == {0.0}
    assert set(asked) == {bytes(range(16))}
    said = capfd.readouterr().err
    for subject in ("absent", "no topic", "no service"):
        assert said.count(f"{subject} cannot be stopped: ") == 1
