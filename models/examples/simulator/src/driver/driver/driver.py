"""Drives the car through a right turn, a command for each pose that the simulated car reports.

It knows no clock of its own: it acts when an event comes, so it works at the pace of the
simulation, whatever that is. JAUS axes are x forward, y right, z down; those of the control laws
are x forward, y left, z up, so y, yaw and yaw rate change sign.
"""

from __future__ import annotations

import logging
import math
import os
import time
from pathlib import Path

from catvehicle.events import EventLog
from catvehicle.parameters import VehicleParameters
from catvehicle.path import Pose, StraightArcStraight
from catvehicle.progress import is_at_goal
from catvehicle.steering import SteeringController
from catvehicle.velocity import VelocityController
from jausml_runtime import ComponentSettings, ControlState, JausAddress, Transport

from .driver_base import ADDRESS, SETTINGS, DriverBase
from .messages import ReportLocalPose, ReportVelocityState, SetVelocityCommand

LOG_FOLDER = "SIMULATOR_LOG"
"""Environment variable that names the folder of the logs; without it nothing is written."""

STANDSTILL = 0.01
"""Speed in m/s below which the car stands."""

_log = logging.getLogger("driver")


class Driver(DriverBase):
    """Follows the path of the example catvehicle by SetVelocityCommand."""

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self._parameters = VehicleParameters()
        self._path = StraightArcStraight.right_turn(self._parameters)
        self._steering = SteeringController(self._parameters, self._path)
        self._velocity = VelocityController(self._parameters)
        self._speed = self._tyre_angle = 0.0
        self._arrived = False
        folder = os.environ.get(LOG_FOLDER)
        self._events = EventLog(Path(folder) / "driver.csv" if folder else None)
        self._events.write("event", "received_s", "stamp_ms", "x_m", "y_m", "psi_rad")

    def on_pose(self, report: ReportLocalPose, provider: JausAddress) -> None:
        """Answers each pose with a command, once the driver is in control."""
        received = time.monotonic()
        if report.x is None or report.y is None or report.yaw is None:
            return
        pose = Pose(report.x, -report.y, -report.yaw)
        self._events.write("pose", received, _milliseconds(report), pose.x, pose.y, pose.psi)
        if self.control_of_simulated_car.state is ControlState.READY:
            self._drive(pose)

    def on_velocity(self, report: ReportVelocityState, provider: JausAddress) -> None:
        """Keeps the speed and the tyre angle that goes with the yaw rate."""
        received = time.monotonic()
        self._events.write("velocity", received, _milliseconds(report), "", "", "")
        if report.velocity_x is None or report.yaw_rate is None:
            return
        self._speed = report.velocity_x
        speed = max(self._speed, self._parameters.steering_speed_floor)
        self._tyre_angle = math.atan(-report.yaw_rate * self._parameters.wheelbase / speed)

    def on_pose_silent(self, provider: JausAddress) -> None:
        """Says that the simulated car stopped reporting."""
        _log.warning("the simulated car does not report")

    def on_velocity_silent(self, provider: JausAddress) -> None:
        """Nothing: `on_pose_silent` has said it."""

    def _drive(self, pose: Pose) -> None:
        angle = self._steering.command(pose, self._speed)
        remaining = self._path.remaining(pose.x, pose.y)
        speed = self._velocity.command(self._tyre_angle, angle, remaining)
        yaw_rate = speed * math.tan(angle) / self._parameters.wheelbase
        self.send(
            SetVelocityCommand(command_type=0, velocity_x=speed, yaw_rate=-yaw_rate),
            self.SIMULATED_CAR,
        )
        stands = abs(self._speed) < STANDSTILL and is_at_goal(self._path, pose.x, pose.y)
        if stands and not self._arrived:
            self._arrived = True
            _log.info("arrived at x %.2f m, y %.2f m (ROS axes)", pose.x, pose.y)


def _milliseconds(report: ReportLocalPose | ReportVelocityState) -> int | str:
    """Returns the time of a report in milliseconds since its day began; empty when it has none."""
    stamp = report.time_stamp
    if stamp is None:
        return ""
    return ((stamp.hour * 60 + stamp.minutes) * 60 + stamp.seconds) * 1000 + stamp.milliseconds
