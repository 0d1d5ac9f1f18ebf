"""The vehicle: a kinematic bicycle with a lag of speed and steering.

Reference point is the centre of the rear axle, where the lateral acceleration is exactly v times
the yaw rate. ROS convention: x forward, y left, yaw counter-clockwise; metres, seconds, radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .path import Pose

if TYPE_CHECKING:
    from .parameters import VehicleParameters

SUBSTEP = 0.001
"""Longest integration step, s."""

REST = 1e-6
"""Speed (m/s) and distance of the tyre angle from its command (rad) that count as rest."""


@dataclass(frozen=True)
class VehicleState:
    """State of the vehicle at the centre of the rear axle.

    Attributes:
        x: Forward position, m.
        y: Left position, m.
        psi: Yaw, rad, counter-clockwise; grows without wrapping.
        v: Speed, m/s.
        delta: Tyre angle of the bicycle model, rad; negative steers right.
    """

    x: float = 0.0
    y: float = 0.0
    psi: float = 0.0
    v: float = 0.0
    delta: float = 0.0

    @property
    def pose(self) -> Pose:
        """Position (m) and yaw (rad)."""
        return Pose(self.x, self.y, self.psi)


class BicyclePlant:
    """A kinematic bicycle that follows commands of speed and tyre angle.

    Speed lags with one time constant up and another down, the tyre angle with its own;
    acceleration, tyre angle and tyre rate saturate. The vehicle does not drive backwards. What
    happens when commands stop is not decided here: the last command holds.
    """

    def __init__(self, parameters: VehicleParameters, state: VehicleState | None = None) -> None:
        """Starts at `state`, by default at rest in the origin, commanded to keep still."""
        self._parameters = parameters
        self._state = state or VehicleState()
        self._speed_command = 0.0
        self._angle_command = 0.0

    @property
    def state(self) -> VehicleState:
        """The state now."""
        return self._state

    @property
    def speed_command(self) -> float:
        """Speed asked for after saturation, m/s."""
        return self._speed_command

    @property
    def steering_command(self) -> float:
        """Tyre angle asked for after saturation, rad."""
        return self._angle_command

    @property
    def yaw_rate(self) -> float:
        """Yaw rate now, rad/s; negative in a right turn."""
        return self._yaw_rate(self._state.v, self._state.delta)

    def command(self, speed: float, steering_angle: float) -> None:
        """Asks for a speed (m/s) and a tyre angle (rad, negative right); both are saturated.

        Raises:
            ValueError: A value is not finite; the earlier command holds.
        """
        if not (math.isfinite(speed) and math.isfinite(steering_angle)):
            raise ValueError(f"command is not finite: {speed} m/s, {steering_angle} rad")
        limit = self._parameters.steering_limit
        self._speed_command = _clamp(speed, 0.0, self._parameters.speed_max)
        self._angle_command = _clamp(steering_angle, -limit, limit)

    def place(self, pose: Pose) -> None:
        """Say where the vehicle is; its motion and its commands go on."""
        self._state = replace(self._state, x=pose.x, y=pose.y, psi=pose.psi)

    def advance(self, dt: float) -> VehicleState:
        """Integrate over exactly `dt` seconds, in equal midpoint steps of 1 ms at most.

        A vehicle at rest is not integrated, so that one that stood for hours answers at once.

        Returns:
            The new state.

        Raises:
            ValueError: `dt` is negative or not finite.
        """
        if not (math.isfinite(dt) and dt >= 0.0):
            raise ValueError(f"time step must be finite and not negative, got {dt} s")
        # The tolerance keeps 0.04 / 0.001 = 40.00000000000001 from becoming 41 steps.
        count = math.ceil(dt / SUBSTEP - 1e-9)
        for _ in range(count):
            if self._is_at_rest:
                self._state = replace(self._state, v=0.0, delta=self._angle_command)
                break
            self._state = self._step(self._state, dt / count)
        return self._state

    @property
    def _is_at_rest(self) -> bool:
        gap = abs(self._angle_command - self._state.delta)
        return self._speed_command == 0.0 and self._state.v < REST and gap < REST

    def _step(self, start: VehicleState, dt: float) -> VehicleState:
        rate = self._derivative(start)
        rate = self._derivative(moved(start, rate, dt / 2))
        return moved(start, rate, dt)

    def _derivative(self, state: VehicleState) -> VehicleState:
        """Returns the rate of every state (per second), in the same order."""
        parameters = self._parameters
        speed_gap = self._speed_command - state.v
        speed_lag = parameters.speed_lag_up if speed_gap > 0.0 else parameters.speed_lag_down
        angle_gap = self._angle_command - state.delta
        rate_limit = parameters.steering_rate_limit
        return VehicleState(
            x=state.v * math.cos(state.psi),
            y=state.v * math.sin(state.psi),
            psi=self._yaw_rate(state.v, state.delta),
            v=_clamp(
                speed_gap / speed_lag, parameters.acceleration_min, parameters.acceleration_max
            ),
            delta=_clamp(angle_gap / parameters.steering_lag, -rate_limit, rate_limit),
        )

    def _yaw_rate(self, speed: float, steering_angle: float) -> float:
        understeer = 1.0 + self._parameters.understeer_coefficient * speed * speed
        return speed * math.tan(steering_angle / understeer) / self._parameters.wheelbase


def moved(state: VehicleState, rate: VehicleState, dt: float) -> VehicleState:
    """Returns the state after `dt` seconds of a rate of change (per second)."""
    return VehicleState(
        state.x + rate.x * dt,
        state.y + rate.y * dt,
        state.psi + rate.psi * dt,
        state.v + rate.v * dt,
        state.delta + rate.delta * dt,
    )


def _clamp(value: float, lowest: float, highest: float) -> float:
    return min(max(value, lowest), highest)
