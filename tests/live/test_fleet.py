"""Two robots from one model, told apart by parameters alone, side by side."""

import subprocess
from pathlib import Path

import needs
import pytest
import warm
from scripts import succeeded

needs.ask("rclpy")

from workspaces import packages_of

from .bridge_support import Repeater, System, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

FLEET = Path(__file__).resolve().parents[2] / "models" / "examples" / "fleet"
ADDRESSES = {"first": "100.1.10", "second": "100.1.20"}


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    command = [*warm.command(), "generate", str(FLEET / "fleet.ros2jaus")]
    subprocess.run([*command, "-o", str(folder / "ws")], check=True, capture_output=True)
    with System(packages_of(folder / "ws"), folder) as system:
        for name in ADDRESSES:
            line = ["-m", "robot.main", "--ros-args", "-r", f"__ns:=/{name}"]
            if name == "second":
                line += ["--params-file", str(FLEET / "second.yaml")]
            system.start(*line, "--")
        for name, robot in zip(ADDRESSES, system.processes, strict=True):
            words = f"/{name}/robot runs as {ADDRESSES[name]}"
            wait_for(lambda log=robot.log, words=words: words in log.read_text(), words)
        yield system.ros, str(system.port)
        for robot in system.processes:
            assert robot.stop() == 0


def ocu(port, *arguments):
    command = [*warm.command(), "ocu", *arguments, "--port", port]
    done = succeeded(command, timeout=60)
    return done.stdout


def odometry(speed):
    from nav_msgs.msg import Odometry

    message = Odometry()
    message.header.frame_id, message.child_frame_id = "odom", "base_link"
    message.twist.twist.linear.x = speed
    return message


def test_both_are_discovered_and_queried_side_by_side(fleet):
    from nav_msgs.msg import Odometry
    from rclpy.qos import qos_profile_sensor_data

    ros, port = fleet
    found = ocu(port, "discover")
    assert all(address in found for address in ADDRESSES.values())
    publishers = {
        name: ros.publisher(Odometry, f"/{name}/odom", qos_profile_sensor_data)
        for name in ADDRESSES
    }
    with (
        Repeater(publishers["first"], odometry(1.25)),
        Repeater(publishers["second"], odometry(-0.75)),
    ):
        for name, speed in (("first", "1.25"), ("second", "-0.75")):
            wait_for(
                lambda name=name, speed=speed: (
                    speed in ocu(port, "query", ADDRESSES[name], "VelocityState")
                ),
                f"speed of {name}",
            )


def test_each_is_driven_alone_with_the_speed_of_its_base(fleet):
    from geometry_msgs.msg import Twist

    ros, port = fleet
    told = {name: ros.listen_to_publisher(Twist, f"/{name}/cmd_vel") for name in ADDRESSES}
    effort = '{"PropulsiveLinearEffortX": 50}'
    for name, speed in (("second", 0.25), ("first", 1.0)):
        for twist_list in told.values():
            twist_list.clear()
        ocu(port, "command", ADDRESSES[name], "SetWrenchEffort", effort, "--duration", "2")
        wait_for(lambda name=name: told[name] and told[name][-1].linear.x == 0.0, f"stop of {name}")
        # The step of an effort is 0.003 percent.
        speeds = {round(twist.linear.x, 3) for twist in told[name]}
        assert speeds == {speed, 0.0}
        (other,) = set(ADDRESSES) - {name}
        assert {twist.linear.x for twist in told[other]} <= {0.0}
