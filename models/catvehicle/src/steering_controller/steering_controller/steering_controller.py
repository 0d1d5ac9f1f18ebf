"""Follows the path by dead reckoning, from reported velocity and tyre angle."""

from __future__ import annotations

import math
import time

from catvehicle import steering
from catvehicle.deadreckoning import DeadReckoning
from catvehicle.events import EventLog
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from .steering_controller_base import SteeringControllerBase


class SteeringController(SteeringControllerBase):
    """Commands a tyre angle for each state that the vehicle reports.

    Velocity and tyre angle come in messages of their own at the same rate. A step waits for both,
    since an angle of the period before would make the dead reckoning drift.
    """

    def __init__(self) -> None:
        super().__init__()
        parameters = VehicleParameters()
        path = StraightArcStraight.right_turn(parameters)
        self._controller = steering.SteeringController(parameters, path)
        self._dead_reckoning = DeadReckoning(parameters)
        self._tyre_angle = 0.0
        self._angle_is_new = False
        self._odometry: Odometry | None = None
        self._received = 0.0
        self._log = EventLog.from_environment("steering_controller")

    def on_steering_angle(self, message: Float64) -> None:
        """Keeps the tyre angle that the vehicle reports, rad."""
        self._tyre_angle = message.data
        self._angle_is_new = True
        if self._odometry is not None:
            self._step(self._odometry)

    def on_odometry(self, message: Odometry) -> None:
        """Keeps the velocity; one that got no angle before the next one came is used without."""
        self._received = time.monotonic()
        if self._odometry is not None:
            self._step(self._odometry)
        self._odometry = message
        if self._angle_is_new:
            self._step(message)

    def _step(self, message: Odometry) -> None:
        """Integrates the pose, publishes it and answers with a command."""
        self._odometry = None
        self._angle_is_new = False
        received = self._received
        stamp = message.header.stamp
        speed = message.twist.twist.linear.x
        pose = self._dead_reckoning.update(
            stamp.sec + stamp.nanosec * 1e-9, speed, self._tyre_angle
        )
        command = Float64(data=self._controller.command(pose, speed))
        sent = time.monotonic()
        self.publish_steering_command(command)
        milliseconds = stamp.sec * 1000 + stamp.nanosec // 1_000_000
        self._log.write(milliseconds, received, sent, command.data)
        estimate = Odometry(child_frame_id=message.child_frame_id, twist=message.twist)
        estimate.header = message.header
        estimate.pose.pose.position.x = pose.x
        estimate.pose.pose.position.y = pose.y
        estimate.pose.pose.orientation.z = math.sin(pose.psi / 2)
        estimate.pose.pose.orientation.w = math.cos(pose.psi / 2)
        self.publish_dead_reckoning(estimate)
