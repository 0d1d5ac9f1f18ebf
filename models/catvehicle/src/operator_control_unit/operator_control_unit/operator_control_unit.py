"""The operator: sets the cruise speed and watches the true and the dead-reckoned pose."""

from __future__ import annotations

import logging

from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from catvehicle.progress import Progress
from jausml_runtime import ComponentSettings, JausAddress, Transport
from jausml_runtime.conversions import Time, timestamp_to_time

from .messages import ReportLocalPose, SetVelocityCommand
from .operator_control_unit_base import ADDRESS, SETTINGS, OperatorControlUnitBase

COMMAND_PERIOD = 0.5
"""Seconds between two cruise commands; the bridge stops the vehicle after two seconds without."""

_log = logging.getLogger("operator")


class OperatorControlUnit(OperatorControlUnitBase):
    """Drives the vehicle by a cruise speed and says how it goes."""

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        parameters = VehicleParameters()
        self._cruise_speed = parameters.reference_speed
        self._progress = Progress(StraightArcStraight.right_turn(parameters))

    def start(self) -> None:
        """Starts the component and the repetition of the cruise command."""
        super().start()
        self._command()

    def _command(self) -> None:
        command = SetVelocityCommand(command_type=0, velocity_x=self._cruise_speed)
        if self.running:
            self.send(command, self.BRIDGE)
            self.loop.call_later(COMMAND_PERIOD, self._command)

    def on_vehicle_pose(self, report: ReportLocalPose, provider: JausAddress) -> None:
        """Shows progress; a report without a time tells nothing about standing."""
        if report.x is None or report.y is None or report.time_stamp is None:
            return
        about_now = Time(int(self.clock.utc().timestamp()), 0)
        sensed = timestamp_to_time(report.time_stamp, near=about_now)
        seconds = sensed.sec + sensed.nanosec / 1e9
        for line in self._progress.take_position(report.x, report.y, seconds):
            _log.info(line)

    def on_vehicle_pose_silent(self, provider: JausAddress) -> None:
        """Says that the vehicle stopped reporting."""
        _log.warning("the vehicle does not report")

    def on_estimated_pose(self, report: ReportLocalPose, provider: JausAddress) -> None:
        """Keeps the pose that the steering controller has integrated."""
        if report.x is not None and report.y is not None:
            self._progress.take_estimate(report.x, report.y)
