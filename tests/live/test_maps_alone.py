"""A file of maps alone, an address and a frequency make a bridge, which finds those of its kind.

So does the paper run its Figure 5. Each of two such bridges is the JAUS peer of the other.
"""

import needs
import pytest

needs.ask("rclpy")

from click.testing import CliRunner
from workspaces import packages_of

from jausml.cli import main

from .bridge_support import Repeater, System, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

MAPS = """\
WinchState {
  JAUS WinchStatus ( uint16 length )
  ROS std_msgs/UInt16 ( uint16 data )
  JAUS->ROS ( length -> data )
  ROS->JAUS ( data -> length )
}
haul {
  JAUS SetWinchLength ( uint16 length )
  ROS std_msgs/UInt16 ( uint16 data )
  JAUS->ROS ( length -> data )
  ROS->JAUS ( data -> length )
}
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("maps")
    maps = folder / "winch.ros2jaus"
    maps.write_text(MAPS)
    options = ["--bridge-address", "100.1.20", "--frequency", "20"]
    result = CliRunner().invoke(main, ["generate", str(maps), "-o", str(folder / "ws"), *options])
    assert result.exit_code == 0, result.output
    return packages_of(folder / "ws")


def test_reports_and_commands_cross_between_two_bridges(path, tmp_path):
    from std_msgs.msg import UInt16

    with System(path, tmp_path) as system:
        system.start("-m", "winch_bridge.main")
        own = ("--jaus-id", "100.1.21", "--ros-args", "-r", "__ns:=/there", "--")
        system.start("-m", "winch_bridge.main", *own)
        for sender, receiver, value in (("", "/there", 5), ("/there", "", 7)):
            for name in ("WinchState", "haul"):
                heard = system.ros.listen(UInt16, f"{receiver}/{name}/from_jaus")
                publisher = system.ros.publisher(UInt16, f"{sender}/{name}/to_jaus")
                with Repeater(publisher, UInt16(data=value)):
                    wait_for(lambda heard=heard: heard, f"{name} at '{receiver}'", 60)
                assert {message.data for message in heard} == {value}
