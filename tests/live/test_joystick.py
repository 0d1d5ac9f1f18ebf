"""A joystick goes from a ROS node through two bridges to another, byte by byte."""

import needs
import pytest

needs.ask("rclpy")

from .bridge_support import Repeater, System, generate_text, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

MODEL = """
import mappings.hmi

bridge desk {
    address: 10.1.1
    provides: AnalogControl, DigitalControl
    connection space { map: analog_action topic spacenav/joy }
    connection button { map: digital_control topic joy }
}

bridge cab {
    address: 10.1.2
    connection space { map: analog_action peers: desk rate: 10 topic cab/spacenav }
    connection button {
        map: digital_control
        peers: desk
        exchange: everyChangeEvent
        topic cab/button
    }
}
"""


@pytest.fixture
def ros(tmp_path):
    """Yields a node of the test while both bridges run."""
    with System(generate_text(tmp_path, "joystick", MODEL), tmp_path) as system:
        for name in ("desk", "cab"):
            system.start("-m", f"{name}.main")
        yield system.ros


def test_each_axis_and_a_button(ros):
    from sensor_msgs.msg import Joy

    # A button that is held is told once: it is pressed when the cab has found who listens.
    buttons = ros.listen_to_publisher(Joy, "cab/button")
    axes = ros.listen(Joy, "cab/spacenav")
    pushed = [0.25, -0.5, 0.75, -1.0, 0.125, 1.0]
    pressed = ros.publisher(Joy, "joy")
    with Repeater(ros.publisher(Joy, "spacenav/joy"), Joy(axes=pushed, buttons=[1])):
        wait_for(lambda: len(axes) > 5, "axes", 60)
        with Repeater(pressed, Joy(buttons=[1, 0])):
            wait_for(lambda: buttons and buttons[-1].buttons[0], "button", 60)
        with Repeater(pressed, Joy(buttons=[0, 1])):
            wait_for(lambda: not buttons[-1].buttons[0], "the release", 60)
    assert list(axes[-1].axes) == pytest.approx(pushed, abs=1 / 32767)
    assert (axes[-1].header.frame_id, list(axes[-1].buttons)) == ("joy", [])
    assert (buttons[-1].header.frame_id, list(buttons[-1].axes)) == ("joy", [])
