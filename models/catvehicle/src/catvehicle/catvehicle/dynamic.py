"""The vehicle with tyres that slip: the linear dynamic bicycle, in the actuators of the kinematic.

Reference point, frames and units are those of `plant`. Law: R. Rajamani, Vehicle Dynamics and
Control, 2nd ed., section 2.3. In a steady turn it understeers by K = m / L^2 (b / C_f - a / C_r),
where a and b are the distances of front and rear axle to the centre of mass.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from .plant import BicyclePlant, VehicleState, moved

if TYPE_CHECKING:
    from .parameters import VehicleParameters

CRAWL = 1.0
"""Speed in m/s below which the tyres roll without slip, since slip angles lose their meaning."""

SETTLING = 0.02
"""Time constant in s with which the slip disappears below that speed."""


class Slip(NamedTuple):
    """What the dynamic bicycle has beside the state of the kinematic one.

    Attributes:
        sideways: Speed of the rear axle to the left, m/s.
        yaw_rate: Yaw rate, rad/s, counter-clockwise.
    """

    sideways: float = 0.0
    yaw_rate: float = 0.0

    def moved(self, rate: Slip, dt: float) -> Slip:
        """Returns the slip after `dt` seconds of a rate of change (per second)."""
        return Slip(self.sideways + rate.sideways * dt, self.yaw_rate + rate.yaw_rate * dt)


class DynamicPlant(BicyclePlant):
    """A bicycle whose axles take side force in proportion to their slip angle."""

    def __init__(self, parameters: VehicleParameters, state: VehicleState | None = None) -> None:
        """Starts at `state` without slip, by default at rest in the origin."""
        super().__init__(parameters, state)
        self._slip = Slip(0.0, self._yaw_rate(self._state.v, self._state.delta))

    @property
    def yaw_rate(self) -> float:
        """Yaw rate now, rad/s; negative in a right turn."""
        return self._slip.yaw_rate

    def _step(self, start: VehicleState, dt: float) -> VehicleState:
        rate, slip_rate = self._rates(start, self._slip)
        middle = moved(start, rate, dt / 2), self._slip.moved(slip_rate, dt / 2)
        rate, slip_rate = self._rates(*middle)
        self._slip = self._slip.moved(slip_rate, dt)
        return moved(start, rate, dt)

    def _rates(self, state: VehicleState, slip: Slip) -> tuple[VehicleState, Slip]:
        """Returns the rates of state and slip, per second."""
        cosine, sine = math.cos(state.psi), math.sin(state.psi)
        rate = replace(
            self._derivative(state),
            x=state.v * cosine - slip.sideways * sine,
            y=state.v * sine + slip.sideways * cosine,
            psi=slip.yaw_rate,
        )
        return rate, self._slip_rate(state, slip)

    def _slip_rate(self, state: VehicleState, slip: Slip) -> Slip:
        if state.v < CRAWL:
            rolling = self._yaw_rate(state.v, state.delta)
            return Slip(-slip.sideways / SETTLING, (rolling - slip.yaw_rate) / SETTLING)
        parameters = self._parameters
        behind = parameters.rear_axle_distance
        ahead = parameters.wheelbase - behind
        at_front = slip.sideways + parameters.wheelbase * slip.yaw_rate
        front = parameters.front_cornering_stiffness * (state.delta - math.atan2(at_front, state.v))
        front *= math.cos(state.delta)
        rear = -parameters.rear_cornering_stiffness * math.atan2(slip.sideways, state.v)
        turning = (ahead * front - behind * rear) / parameters.yaw_inertia
        pushing = (front + rear) / parameters.mass - state.v * slip.yaw_rate
        return Slip(pushing - behind * turning, turning)
