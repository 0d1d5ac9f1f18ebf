"""Pose by dead reckoning: integrated from reported speed and tyre angle, never received.

ROS convention: x forward, y left, yaw counter-clockwise; metres, seconds, radians.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .path import Pose

if TYPE_CHECKING:
    from .parameters import VehicleParameters


class DeadReckoning:
    """Integrates the pose of the rear axle with the bicycle model from timestamped reports."""

    def __init__(self, parameters: VehicleParameters, pose: Pose | None = None) -> None:
        """Starts at `pose` (the origin by default); the first report sets the clock."""
        self._parameters = parameters
        self._pose = pose or Pose()
        self._last: tuple[float, float, float] | None = None

    @property
    def pose(self) -> Pose:
        """Pose at the time of the last report taken; psi (rad) grows without wrapping."""
        return self._pose

    @property
    def time(self) -> float | None:
        """Time of the last report taken, s; None before the first."""
        return None if self._last is None else self._last[0]

    def update(self, time: float, speed: float, steering_angle: float) -> Pose:
        """Takes one report and returns the pose at its time.

        Between two reports speed and tyre angle are taken to change linearly; their means are used.
        A report that is not newer than the last one (a duplicate, or overtaken on the way) changes
        nothing.

        Args:
            time: Time at which the vehicle sensed the values, s, on the vehicle's clock.
            speed: Reported speed, m/s.
            steering_angle: Reported tyre angle, rad; negative is right.

        Raises:
            ValueError: A value is not finite; the pose stays.
        """
        if not all(map(math.isfinite, (time, speed, steering_angle))):
            raise ValueError(f"report is not finite: {time} s, {speed} m/s, {steering_angle} rad")
        report = (time, speed, steering_angle)
        if self._last is None:
            self._last = report
        elif time > self._last[0]:
            self._pose = self._integrate(self._last, report)
            self._last = report
        return self._pose

    def _integrate(
        self, earlier: tuple[float, float, float], later: tuple[float, float, float]
    ) -> Pose:
        dt = later[0] - earlier[0]
        speed = (earlier[1] + later[1]) / 2
        angle = (earlier[2] + later[2]) / 2
        understeer = 1.0 + self._parameters.understeer_coefficient * speed * speed
        turned = dt * speed * math.tan(angle / understeer) / self._parameters.wheelbase
        chord = Pose(self._pose.x, self._pose.y, self._pose.psi + turned / 2).ahead(speed * dt)
        return Pose(chord.x, chord.y, self._pose.psi + turned)
