"""An emergency stop of ROS and the emergency of JAUS press and release each other, both ways."""

from pathlib import Path

import needs
import pytest

needs.ask("rclpy")

from .bridge_support import Process, RosPeer, generate, wait_for

pytestmark = pytest.mark.live

MODEL = Path(__file__).with_name("emergency_stop.ros2jaus")


@pytest.fixture
def ros(tmp_path):
    """A node beside the bridges of the robot and of the panel, which run."""
    path = generate(MODEL)
    peer = RosPeer()
    bridges = [
        Process(["-m", f"{name}.main"], path, tmp_path / name) for name in ("rover", "panel")
    ]
    yield peer
    peer.close()
    codes = [bridge.stop() for bridge in bridges]
    told = "".join(bridge.log.read_text("utf-8") for bridge in bridges)
    assert codes == [0, 0], told
    assert "is degraded: messages are dropped" not in told


def test_it_is_pressed_and_released_from_either_side(ros):
    from std_msgs.msg import Bool
    from std_srvs.srv import SetBool

    calls = []

    def brake(request, response):
        calls.append(request.data)
        response.success = True
        return response

    ros.node.create_service(SetBool, "brake", brake)
    pressed = ros.listen_to_publisher(Bool, "e_stop/set")
    states = ros.listen_to_publisher(Bool, "panel/emergency")
    panel, robot = (ros.publisher(Bool, topic_name) for topic_name in ("panel/e_stop", "e_stop"))

    def is_in_emergency(value):
        seen = len(states)
        wait_for(lambda: [state.data for state in states[seen:]][-1:] == [value], "state")

    is_in_emergency(False)
    robot.publish(Bool(data=True))
    is_in_emergency(True)
    wait_for(lambda: pressed, "stop of ROS")
    wait_for(lambda: calls, "call of the brake")
    for value in (True, False):
        panel.publish(Bool(data=value))
    is_in_emergency(True)  # that of the robot stands
    assert [message.data for message in pressed] == [True]
    robot.publish(Bool(data=False))
    is_in_emergency(False)
    wait_for(lambda: len(pressed) == 2, "release in ROS")
    assert [message.data for message in pressed] == [True, False]
    assert calls == [True]
    for value in (True, False):
        panel.publish(Bool(data=value))
        is_in_emergency(value)
    wait_for(lambda: len(pressed) == 4, "stop and release by the panel")
    assert [message.data for message in pressed] == [True, False] * 2
