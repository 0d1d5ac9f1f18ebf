"""The car: a bicycle plant behind JAUS."""

from __future__ import annotations

import math
from dataclasses import astuple
from typing import TYPE_CHECKING

from catvehicle.events import EventLog
from catvehicle.metrics import COLUMNS, Sample
from catvehicle.parameters import VehicleParameters
from catvehicle.path import Pose
from catvehicle.plants import delay_from_environment, plant_from_environment
from catvehicle.realtime import RealTimePlant
from jausml_runtime import ComponentSettings, JausAddress, Transport

from .messages import (
    QueryLocalPose,
    QueryVelocityState,
    QueryWrenchEffort,
    ReportLocalPose,
    ReportVelocityState,
    ReportWrenchEffort,
    SetLocalPose,
    SetWrenchEffort,
)
from .vehicle_base import ADDRESS, SETTINGS, VehicleBase

if TYPE_CHECKING:
    from datetime import datetime


class Vehicle(VehicleBase):
    """Drives the plant by SetWrenchEffort and reports its state.

    JAUS axes are x forward, y right, z down; the plant's are x forward, y left, z up. So y, yaw,
    yaw rate and tyre angle change sign on the way in and out.
    """

    # JAUS-DEVIATION: AS6009 calls PrimitiveDriver open loop effort. Here linear effort x is the
    # speed set-point and rotational effort z the tyre angle, in percent of their limits, as the
    # drive by wire kit of the original vehicle takes them; no standard mobility message carries a
    # tyre angle.

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self._parameters = VehicleParameters()
        self._delay = delay_from_environment()
        self._truth = EventLog.from_environment("vehicle")
        self._truth.write(*COLUMNS)
        plant = plant_from_environment(self._parameters)
        record = self._write_truth if self._truth.is_open else None
        self._plant = RealTimePlant(self._parameters, self.clock.now, plant, record)
        self._events = EventLog.from_environment("vehicle_events")
        self._events.write("start", self._plant.started, 0)

    def _write_truth(self, sample: Sample) -> None:
        self._truth.write(*astuple(sample))

    def on_set_wrench_effort(self, message: SetWrenchEffort, sender: JausAddress) -> None:
        """Takes the efforts that are present; an absent one keeps its last value."""
        if self._delay:
            self.loop.call_later(self._delay, lambda: self._obey(message))
        else:
            self._obey(message)

    def _obey(self, message: SetWrenchEffort) -> None:
        linear, rotational = (
            message.propulsive_linear_effort_x,
            message.propulsive_rotational_effort_z,
        )
        if linear is not None:
            speed = linear / 100 * self._parameters.speed_max
            self._plant.command_speed(speed)
            self._events.write("speed", self.clock.now(), speed)
        if rotational is not None:
            angle = -rotational / 100 * self._parameters.steering_limit
            self._plant.command_steering(angle)
            self._events.write("command", self.clock.now(), angle)

    def on_set_local_pose(self, message: SetLocalPose, sender: JausAddress) -> None:
        """Takes the parts of a pose that are present as where the vehicle is."""
        state = self._plant.state()
        x = state.x if message.x is None else message.x
        y = state.y if message.y is None else -message.y
        psi = state.psi if message.yaw is None else -message.yaw
        self._plant.place(Pose(x, y, psi))

    def on_not_ready(self) -> None:
        """Stops: nobody may drive."""
        self._plant.stop()

    def on_control_lost(self) -> None:
        """Stops: who takes over begins from standstill."""
        self._plant.stop()

    def report_velocity_state(
        self, query: QueryVelocityState, sender: JausAddress
    ) -> ReportVelocityState:
        """Returns the velocity of the rear axle."""
        state = self._plant.state()
        now = self.clock.utc()
        self._events.write("report", self.clock.now(), int(now.timestamp() * 1000))
        return ReportVelocityState(
            velocity_x=state.v,
            velocity_y=0.0,
            yaw_rate=-self._plant.yaw_rate,
            time_stamp=_stamp(now),
        )

    def report_wrench_effort(
        self, query: QueryWrenchEffort, sender: JausAddress
    ) -> ReportWrenchEffort:
        """Returns what was achieved: speed and tyre angle in percent of their limits."""
        state = self._plant.state()
        return ReportWrenchEffort(
            propulsive_linear_effort_x=100 * state.v / self._parameters.speed_max,
            propulsive_rotational_effort_z=-100 * state.delta / self._parameters.steering_limit,
        )

    def report_local_pose(self, query: QueryLocalPose, sender: JausAddress) -> ReportLocalPose:
        """Returns the pose of the rear axle."""
        state = self._plant.state()
        yaw = -math.remainder(state.psi, math.tau)
        stamp = _stamp(self.clock.utc())
        return ReportLocalPose(x=state.x, y=-state.y, yaw=yaw, time_stamp=stamp)


def _stamp(now: datetime) -> ReportLocalPose.TimeStamp:
    """Returns the time stamp of a report that is made now (UTC)."""
    return ReportLocalPose.TimeStamp(
        milliseconds=now.microsecond // 1000,
        seconds=now.second,
        minutes=now.minute,
        hour=now.hour,
        day=now.day,
    )
