"""Writes what crosses the bridge to a file."""

from __future__ import annotations

import time

from catvehicle.events import EventLog
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from .logger_base import LoggerBase


class Logger(LoggerBase):
    """One row for each message: topic, time of arrival (monotonic, s) and its values."""

    def __init__(self) -> None:
        super().__init__()
        self._log = EventLog.from_environment("logger")

    def on_odometry(self, message: Odometry) -> None:
        """Logs forward speed (m/s) and yaw rate (rad/s)."""
        twist = message.twist.twist
        self._log.write("odometry", time.monotonic(), twist.linear.x, twist.angular.z)

    def on_pose(self, message: PoseStamped) -> None:
        """Logs the position (m)."""
        position = message.pose.position
        self._log.write("pose", time.monotonic(), position.x, position.y)

    def on_steering_command(self, message: Float64) -> None:
        """Logs the commanded tyre angle (rad)."""
        self._log.write("steering_command", time.monotonic(), message.data)

    def on_speed_command(self, message: TwistStamped) -> None:
        """Logs the commanded speed (m/s)."""
        self._log.write("speed_command", time.monotonic(), message.twist.linear.x)
