"""The operator: sets the cruise speed and watches the true and the dead-reckoned pose."""

from __future__ import annotations

import logging
import math

from catvehicle.parameters import VehicleParameters
from jausml_runtime import ComponentSettings, JausAddress, Transport

from .messages import ReportLocalPose, SetVelocityCommand
from .operator_control_unit_base import ADDRESS, SETTINGS, OperatorControlUnitBase

COMMAND_PERIOD = 0.5
"""Seconds between two cruise commands; the bridge stops the vehicle after two seconds without."""

PROGRESS_EVERY = 10
"""Reports of the vehicle's pose for each line of progress."""

STANDSTILL = 0.01
"""Metres between two reports, a tenth of a second apart, below which the vehicle stands."""

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
        self._cruise_speed = VehicleParameters().reference_speed
        self._position: tuple[float, float] | None = None
        self._estimate: tuple[float, float] | None = None
        self._reports = 0
        self._moved = False
        self._arrived = False

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
        """Shows progress, and says so once the vehicle stands at the end of its way."""
        if report.x is None or report.y is None:
            return
        last, self._position = self._position, (report.x, report.y)
        travelled = math.dist(last, self._position) if last is not None else 0.0
        self._moved = self._moved or math.hypot(*self._position) > 1.0
        self._reports += 1
        if self._reports % PROGRESS_EVERY == 0:
            gap = (
                math.dist(self._position, self._estimate)
                if self._estimate is not None
                else math.nan
            )
            _log.info(
                "vehicle at x %6.2f m, y %6.2f m (JAUS axes), %4.1f m/s; estimate off by %.2f m",
                report.x,
                report.y,
                travelled * 10,
                gap,
            )
        if self._moved and not self._arrived and travelled < STANDSTILL:
            self._arrived = True
            _log.info("arrived at x %.2f m, y %.2f m", report.x, report.y)

    def on_vehicle_pose_silent(self, provider: JausAddress) -> None:
        """Says that the vehicle stopped reporting."""
        _log.warning("the vehicle does not report")

    def on_estimated_pose(self, report: ReportLocalPose, provider: JausAddress) -> None:
        """Keeps the pose that the steering controller has integrated."""
        if report.x is not None and report.y is not None:
            self._estimate = (report.x, report.y)
