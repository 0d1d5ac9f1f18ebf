#!/usr/bin/env python3
"""A simulated robot on two wheels: takes robot/cmd_vel (Twist), publishes robot/odom (Odometry).

The wheels follow their speeds with a lag, and stop when no command came for half a second. What
robot/set_pose (PoseWithCovarianceStamped) says is where the robot is from then on. The parameter
`log` names a file to which the true state is written at each step.

Usage: python wheels.py [--ros-args -p log:=FILE]
"""

from __future__ import annotations

import math
import signal
import sys
import time
from pathlib import Path
from typing import TextIO

import rclpy
from driving import COLUMNS, PERIOD, Body
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

PATIENCE = 0.5
"""Seconds after the last command when the wheels stop."""


class Wheels(Node):
    """Drives the robot."""

    def __init__(self) -> None:
        """Begins at rest in the origin of odom."""
        super().__init__("wheels", namespace="robot")
        self._rows: TextIO | None = None
        if log := self.declare_parameter("log", "").value:
            self._rows = Path(log).open("w", encoding="utf-8", buffering=1)  # noqa: SIM115 - kept
            self._rows.write(f"{COLUMNS}\n")
        self._robot = Body()
        self._wanted = (0.0, 0.0)
        self._now = time.monotonic()
        self._commanded = self._now
        self._odometry = self.create_publisher(Odometry, "odom", 10)
        self.create_subscription(Twist, "cmd_vel", self._on_command, 1)
        self.create_subscription(PoseWithCovarianceStamped, "set_pose", self._on_pose, 1)
        self.create_timer(PERIOD, self._step)

    def _on_command(self, command: Twist) -> None:
        speed, yaw_rate = command.linear.x, command.angular.z
        if math.isfinite(speed) and math.isfinite(yaw_rate):
            self._wanted = (speed, yaw_rate)
            self._commanded = time.monotonic()

    def _on_pose(self, stated: PoseWithCovarianceStamped) -> None:
        position, turn = stated.pose.pose.position, stated.pose.pose.orientation
        self._robot.x, self._robot.y = position.x, position.y
        self._robot.psi = 2 * math.atan2(turn.z, turn.w)

    def _step(self) -> None:
        now = time.monotonic()
        wanted = self._wanted if now - self._commanded < PATIENCE else (0.0, 0.0)
        robot = self._robot
        robot.advance(*wanted, now - self._now)
        self._now = now
        if self._rows is not None:
            self._rows.write(robot.row(now))
        odometry = Odometry(child_frame_id="base_link")
        odometry.header.stamp = self.get_clock().now().to_msg()
        odometry.header.frame_id = "odom"
        position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
        position.x, position.y = robot.x, robot.y
        orientation.z, orientation.w = math.sin(robot.psi / 2), math.cos(robot.psi / 2)
        odometry.twist.twist.linear.x = robot.speed
        odometry.twist.twist.angular.z = robot.yaw_rate
        self._odometry.publish(odometry)


def main() -> None:
    """Drives until the process is asked to end."""
    # By handlers of its own: those of rclpy pull the context away below a node that spins.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    rclpy.spin(Wheels())


if __name__ == "__main__":
    main()
