"""What the translations of ready maps cost, beside the making of an empty ROS message.

Everything runs in this process: no socket and no executor, so that the figures are those of the
generated code alone.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from nav_msgs.msg import Path as PathMessage
from sensor_msgs.msg import LaserScan

from jausml.generation import render
from jausml.generators.bridge.target import TARGET as BRIDGES
from jausml.generators.messages.target import TARGET as MESSAGES
from jausml.generators.runtime.target import TARGET as RUNTIME
from jausml.model import read_models
from jausml.text.notation import NOTATIONS

SYSTEM = """
import mappings.range_sensor
import mappings.velocity_state_sensor
import mappings.waypoint_lists

component peer {
  address: 1.1.1
  provides: RangeSensor, VelocityStateSensor, LocalWaypointListDriver
}
bridge front {
  address: 1.1.2
  provides: RangeSensor
  connection velocity { map: velocity_state  exchange: periodicEvent  peers: peer  topic odom { } }
  connection scan { map: laser_scan  direction: rosToJaus  exchange: periodicEvent  topic scan { } }
  connection path { map: local_waypoint_list  direction: rosToJaus  peers: peer  topic path { } }
}
"""
SECONDS = 0.4
"""Time for each measurement."""


def generate(folder: Path) -> None:
    """Writes the packages of the bridge and makes them importable."""
    path = folder / "system.ros2jaus"
    path.write_text(SYSTEM, encoding="utf-8")
    model = read_models([path], project_root=folder, notations=NOTATIONS).model
    for artifact in render(model, [BRIDGES, MESSAGES, RUNTIME]):
        target = folder / "src" / artifact.path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(artifact.text, encoding="utf-8")
    sys.path[:0] = [str(each) for each in (folder / "src").iterdir()]


def microseconds(action: Callable[[], object]) -> float:
    """Returns the time of a call: the best of five runs, since others use the machine too."""
    best = float("inf")
    for _ in range(5):
        count, started = 0, time.perf_counter()
        while (elapsed := time.perf_counter() - started) < SECONDS / 5:
            for _ in range(20):
                action()
            count += 20
        best = min(best, elapsed / count)
    return 1e6 * best


def main() -> None:
    """Measures a velocity, a laser scan and a path."""
    with tempfile.TemporaryDirectory() as folder:
        generate(Path(folder))
        bridge = importlib.import_module("front.front").Front()
        messages = importlib.import_module("front.messages")
        velocity = messages.ReportVelocityState(velocity_x=5.0, velocity_y=0.0, yaw_rate=0.1)
        scan = LaserScan(angle_increment=0.0174, range_max=30.0, ranges=[1.5] * 360)
        path = PathMessage(poses=[PoseStamped() for _ in range(100)])
        made = microseconds(Odometry)
        print(f"{'making an Odometry':48} {made:10,.1f} us")
        for name, action in {
            "ReportVelocityState to Odometry": lambda: bridge.translate_velocity(velocity),
            "LaserScan of 360 beams to ReportRangeSensorData": lambda: bridge.translate_scan(scan),
            "Path of 100 poses to SetElement": lambda: bridge.translate_path(path),
        }.items():
            assert action() is not None
            cost = microseconds(action)
            print(f"{name:48} {cost:10,.1f} us, {cost / made:6.1f} times as long")


if __name__ == "__main__":
    main()
