"""A bridge that `jausml partition` has split carries by two processes what it did by one."""

from __future__ import annotations

import sys

import pytest
from click.testing import CliRunner
from ports import free_domain, free_port

pytest.importorskip("rclpy")

from pathlib import Path

from jausml.cli import main

from .bridge_support import MODEL, Process, Repeater, RosPeer, generate, wait_for

pytestmark = [
    pytest.mark.live,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

VEHICLE = str(Path(__file__).resolve().parent / "bridge_vehicle.py")
PARTS = ("loop_bridge", "loop_bridge_2")


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """Folders with the packages of the two bridges."""
    folder = tmp_path_factory.mktemp("split")
    model = folder / "split.xmi"
    options = ["--bridges", "2", "-o", str(model), "--allow-outside"]
    done = CliRunner().invoke(main, ["partition", str(MODEL), *options])
    assert done.exit_code == 0, done.output
    return generate(folder / "src", model)


@pytest.fixture(scope="module")
def running(packages, tmp_path_factory):
    """The two bridges, the vehicle and the trailer, and a node."""
    whole, logs = generate(tmp_path_factory.mktemp("whole")), tmp_path_factory.mktemp("logs")
    port = ["--jaus-port", str(free_port())]
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        environment.setenv("ROS_DOMAIN_ID", free_domain())
        ros = RosPeer()
        made = {
            name: Process(["-m", f"{name}.main", *port], packages, logs / name) for name in PARTS
        }
        for name in ("10.1.1", "10.1.2"):
            made[name] = Process([VEHICLE, "--address", name, *port], whole, logs / name)
        yield made, ros
        for process in made.values():
            process.close()
            sys.stderr.write(process.log.read_text())
        ros.close()


def test_reports_and_commands_cross(running):
    from geometry_msgs.msg import PoseStamped, Twist
    from nav_msgs.msg import Odometry
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    processes, ros = running
    best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    odometry = ros.listen(Odometry, "odometry", best_effort)
    pose = ros.listen(PoseStamped, "pose", best_effort)
    wait_for(lambda: len(odometry) > 3 and len(pose) > 3, "odometry and pose")
    command = Twist()
    command.linear.x = 1.0
    with Repeater(ros.publisher(Twist, "cmd_vel"), command):
        for name in ("10.1.1", "10.1.2"):
            found = wait_for(lambda name=name: commands(processes[name]), f"command to {name}")
            # One of the parts alone has control.
            assert {each["sender"] for each in found} <= {"10.1.9", "10.1.10"}
            assert len({each["sender"] for each in found}) == 1


def commands(vehicle):
    """Efforts that came from the topic; the safe value has no rotational effort."""
    return [each for each in vehicle.of_kind("effort") if each["rotational"] is not None]
