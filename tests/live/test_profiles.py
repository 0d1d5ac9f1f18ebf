"""The profiles of IOP run, and have full marks for the behaviour of their core services."""

import importlib.util
import os
import re
import subprocess
import sys

import needs
import pytest
import warm
from ports import free_domain, free_port
from profiles import ADDRESSES, decided
from scripts import ran
from sweeps import sweep
from workspaces import python_path

needs.ask("rclpy")

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(240)]

MAIN = {
    "iop-ugv": "vehicle.main",
    "iop-payload": "payload.main",
    "iop-manipulator": "arm.main",
    "iop-operator": "unit.main",
}
TASKS = ("discovery", "liveness", "events", "access", "management")


HAS_NAV2 = importlib.util.find_spec("nav2_msgs") is not None
"""Whether Python has the messages of the waypoint follower; no wheel has them."""


def without_waypoints(text):
    """Returns the model of a vehicle that takes no lists."""
    text = text.replace("LocalWaypointListDriver, ", "")
    return re.sub(r"        /\*\* Waypoints.*?\n        }\n", "", text, flags=re.DOTALL)


def jausml(*arguments):
    return ran([*warm.command(), *map(str, arguments)], timeout=180)


@pytest.mark.parametrize("profile", sweep(ADDRESSES, every=4))
def test_it_has_full_marks(profile, tmp_path):
    assert jausml("init", tmp_path, "--from", profile, "--name", "robot").returncode == 0
    model = tmp_path / "models" / "robot.ros2jaus"
    text = decided(profile, model.read_text(encoding="utf-8"))
    model.write_text(text if HAS_NAV2 else without_waypoints(text), encoding="utf-8")
    done = jausml("generate", model, "-o", tmp_path / "src")
    assert done.returncode == 0, done.stderr
    port, address = free_port(), ADDRESSES[profile]
    environment = {
        **os.environ,
        "PYTHONPATH": python_path(tmp_path / "src"),
        "ROS_DOMAIN_ID": free_domain(),
    }
    process = subprocess.Popen(
        [sys.executable, "-m", MAIN[profile], "--jaus-port", str(port)],
        env=environment,
        stderr=subprocess.DEVNULL,
    )
    try:
        ready = jausml("ocu", "status", address, "--port", port, "--timeout", 60)
        assert ready.returncode == 0, ready.stderr
        only = [word for task in TASKS for word in ("--only", task)]
        network = ("--port", port, "--quiet-time", 0.1)
        done = jausml("judge", address, "--competition", "conformance", *network, *only)
        assert done.returncode == 0, done.stdout
    finally:
        process.terminate()
        process.wait(30)
