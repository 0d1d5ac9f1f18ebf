"""Follows the path by dead reckoning, from reported velocity and tyre angle."""

from __future__ import annotations

import math
import time

from catvehicle.events import EventLog
from catvehicle.logic import SpeedReport, SteeringLogic, SteeringStep
from catvehicle.parameters import VehicleParameters
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from .steering_controller_base import SteeringControllerBase


class SteeringController(SteeringControllerBase):
    """The steering law behind topics: a command for each state that the vehicle reports."""

    def __init__(self) -> None:
        super().__init__()
        self._logic = SteeringLogic(VehicleParameters())
        self._log = EventLog.from_environment("steering_controller")

    def on_steering_angle(self, message: Float64) -> None:
        """Takes the tyre angle that the vehicle reports, rad."""
        self._logic.take_angle(message.data, time.monotonic())

    def on_odometry(self, message: Odometry) -> None:
        """Takes the velocity that the vehicle reports."""
        stamp = message.header.stamp
        milliseconds = stamp.sec * 1000 + stamp.nanosec // 1_000_000
        report = SpeedReport(milliseconds, message.twist.twist.linear.x, time.monotonic())
        self._answer(self._logic.take_speed(report))

    def _answer(self, step: SteeringStep) -> None:
        """Publishes command and pose of a step."""
        sent = time.monotonic()
        self.publish_steering_command(Float64(data=step.command))
        report = step.report
        self._log.write(report.stamp_ms, report.received, sent, step.command)
        estimate = Odometry(child_frame_id="rear_axle")
        estimate.header.frame_id = "odom"
        estimate.header.stamp.sec = report.stamp_ms // 1000
        estimate.header.stamp.nanosec = report.stamp_ms % 1000 * 1_000_000
        estimate.twist.twist.linear.x = report.speed
        estimate.pose.pose.position.x = step.pose.x
        estimate.pose.pose.position.y = step.pose.y
        estimate.pose.pose.orientation.z = math.sin(step.pose.psi / 2)
        estimate.pose.pose.orientation.w = math.cos(step.pose.psi / 2)
        self.publish_dead_reckoning(estimate)
