"""A file of maps alone, an address and a frequency make a bridge, which finds those of its kind.

So does the paper run its Figure 5. Each of two such bridges is the JAUS peer of the other.
"""

import needs
import pytest
from ports import free_domain, free_port

needs.ask("rclpy")

from click.testing import CliRunner
from workspaces import packages_of

from jausml.cli import main

from .bridge_support import Process, Repeater, RosPeer, wait_for

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


def test_reports_and_commands_cross_between_two_bridges(path, tmp_path, monkeypatch):
    from std_msgs.msg import UInt16

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    port = str(free_port())
    line = ["-m", "winch_bridge.main", "--jaus-port", port]
    ros = RosPeer()
    here = Process(line, path, tmp_path / "here.log")
    there = Process(
        [*line, "--jaus-id", "100.1.21", "--ros-args", "-r", "__ns:=/there"],
        path,
        tmp_path / "there.log",
    )
    try:
        for sender, receiver, value in (("", "/there", 5), ("/there", "", 7)):
            for name in ("WinchState", "haul"):
                heard = ros.listen(UInt16, f"{receiver}/{name}/from_jaus")
                publisher = ros.publisher(UInt16, f"{sender}/{name}/to_jaus")
                with Repeater(publisher, UInt16(data=value)):
                    wait_for(lambda heard=heard: heard, f"{name} at '{receiver}'", 60)
                assert {message.data for message in heard} == {value}
    finally:
        for process in (here, there):
            process.close()
        ros.close()
