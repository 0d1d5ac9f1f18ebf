"""The steering controller of the example hands reports to its logic and publishes the steps."""

import json
import os
import shutil
import sys
from pathlib import Path

import pytest
from generated import model_of
from scripts import succeeded

from jausml.generation.workspace import generate
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.runtime.target import TARGET as RUNTIME

EXAMPLE = Path(__file__).resolve().parents[2] / "models" / "catvehicle"
pytestmark = pytest.mark.live

SCRIPT = """
import json, sys
import rclpy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64
from steering_controller.steering_controller import SteeringController

class Observed(SteeringController):
    def __init__(self):
        self.steps = []
        super().__init__()

    def publish_dead_reckoning(self, message):
        self.steps.append((message.header.stamp.nanosec // 1_000_000, message.twist.twist.linear.x))

rclpy.init()
node = Observed()
for kind, value in json.loads(sys.argv[1]):
    if kind == "angle":
        node.on_steering_angle(Float64(data=value))
    else:
        message = Odometry()
        message.header.stamp.nanosec = value * 1_000_000
        message.twist.twist.linear.x = value / 10
        node.on_odometry(message)
print(json.dumps(node.steps))
node.destroy_node()
rclpy.shutdown()
"""


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Generates the example; returns the folders for the module path."""
    workspace = tmp_path_factory.mktemp("steering") / "ws"
    shutil.copytree(EXAMPLE / "src", workspace, ignore=shutil.ignore_patterns("__pycache__"))
    generate(model_of(EXAMPLE / "catvehicle.xmi"), [ROS_NODE, RUNTIME], workspace)
    return [
        str(workspace / name) for name in ("jausml_runtime", "steering_controller", "catvehicle")
    ]


def test_steps(packages):
    messages = [("angle", 0.1), ("odometry", 1), ("odometry", 2), ("angle", 0.2), ("odometry", 3)]
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(packages),
        "ROS_DOMAIN_ID": "90",
    }
    result = succeeded(
        [sys.executable, "-c", SCRIPT, json.dumps(messages)], env=environment, timeout=60
    )
    assert json.loads(result.stdout) == [[1, 0.1], [2, 0.2], [3, 0.3]]
