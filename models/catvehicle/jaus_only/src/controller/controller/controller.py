"""Follows the path by dead reckoning at a comfortable speed: both laws behind JAUS."""

from __future__ import annotations

import math

from catvehicle.events import EventLog
from catvehicle.logic import SpeedLogic, SpeedReport, SteeringLogic, SteeringStep
from catvehicle.parameters import VehicleParameters
from jausml_runtime import ComponentSettings, JausAddress, Priority, Transport
from jausml_runtime.conversions import Time, timestamp_to_time

from .controller_base import ADDRESS, SETTINGS, ControllerBase
from .messages import (
    QueryAccelerationLimit,
    QueryLocalPose,
    QueryVelocityCommand,
    ReportAccelerationLimit,
    ReportLocalPose,
    ReportVelocityCommand,
    ReportVelocityState,
    ReportWrenchEffort,
    SetAccelerationLimit,
    SetLocalPose,
    SetVelocityCommand,
    SetWrenchEffort,
)


class Controller(ControllerBase):
    """Answers each state that the vehicle reports with a tyre angle and a speed.

    JAUS axes are x forward, y right, z down; those of the laws are x forward, y left, z up. So y,
    yaw and tyre angle change sign on the way in and out.
    """

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self._parameters = VehicleParameters()
        self._steering = SteeringLogic(self._parameters)
        self._speed = SpeedLogic(self._parameters)
        self._cruise_speed = 0.0
        self._estimate: ReportLocalPose | None = None
        self._log = EventLog.from_environment("steering_controller")

    def on_set_velocity_command(self, message: SetVelocityCommand, sender: JausAddress) -> None:
        """Keeps the speed that the operator allows."""
        if message.velocity_x is not None:
            self._cruise_speed = message.velocity_x
            self._speed.take_cruise_speed(message.velocity_x)

    def report_velocity_command(
        self, query: QueryVelocityCommand, sender: JausAddress
    ) -> ReportVelocityCommand:
        """Returns the speed that the operator allows."""
        return ReportVelocityCommand(command_type=0, velocity_x=self._cruise_speed)

    def on_set_acceleration_limit(self, message: SetAccelerationLimit, sender: JausAddress) -> None:
        """Counts the limit only: the vehicle keeps its own."""
        self.counters.count("controller.limit_ignored", f"{message.NAME} from {sender}")

    def report_acceleration_limit(
        self, query: QueryAccelerationLimit, sender: JausAddress
    ) -> ReportAccelerationLimit | None:
        """Returns nothing: there is no limit."""
        return None

    def on_set_local_pose(self, message: SetLocalPose, sender: JausAddress) -> None:
        """Counts the pose only: the estimate begins at the start of the path."""
        self.counters.count("controller.pose_ignored", f"{message.NAME} from {sender}")

    def on_not_ready(self) -> None:
        """Stops the vehicle by the next command: nobody lets it move."""
        self._stop()

    def on_control_lost(self) -> None:
        """Stops the vehicle by the next command: the operator is gone."""
        self._stop()

    def _stop(self) -> None:
        self._cruise_speed = 0.0
        self._speed.take_cruise_speed(0.0)

    def on_effort(self, report: ReportWrenchEffort, provider: JausAddress) -> None:
        """Takes the tyre angle that the vehicle achieved, in percent of its limit."""
        effort = report.propulsive_rotational_effort_z
        if effort is not None:
            angle = -effort / 100 * self._parameters.steering_limit
            self._speed.take_measured_angle(angle)
            self._steering.take_angle(angle, self.clock.now())

    def on_velocity(self, report: ReportVelocityState, provider: JausAddress) -> None:
        """Takes the velocity; one without a time is of no use to the dead reckoning."""
        if report.velocity_x is None or report.time_stamp is None:
            return
        about_now = Time(int(self.clock.utc().timestamp()), 0)
        sensed = timestamp_to_time(report.time_stamp, near=about_now)
        milliseconds = sensed.sec * 1000 + sensed.nanosec // 1_000_000
        speed = SpeedReport(milliseconds, report.velocity_x, self.clock.now())
        self._answer(self._steering.take_speed(speed))

    def _answer(self, step: SteeringStep) -> None:
        """Commands both efforts of a step, and tells the estimated pose."""
        parameters = self._parameters
        self._speed.take_commanded_angle(step.command)
        speed = self._speed.command(step.pose.x, step.pose.y)
        sent = self.clock.now()
        command = SetWrenchEffort(
            propulsive_linear_effort_x=100 * speed / parameters.speed_max,
            propulsive_rotational_effort_z=-100 * step.command / parameters.steering_limit,
            resistive_linear_effort_x=0,
        )
        self.send(command, self.VEHICLE, priority=Priority.HIGH)
        report = step.report
        self._log.write(report.stamp_ms, report.received, sent, step.command)
        pose = step.pose
        yaw = -math.remainder(pose.psi, math.tau)
        self._estimate = ReportLocalPose(x=pose.x, y=-pose.y, yaw=yaw)
        self.report_changed(ReportLocalPose)

    def report_local_pose(
        self, query: QueryLocalPose, sender: JausAddress
    ) -> ReportLocalPose | None:
        """Returns the estimated pose of the rear axle; None before the first step."""
        return self._estimate
