"""The velocity controller: as fast as wanted, but never uncomfortable for the present tyre angle.

Speeds in m/s, angles in rad, lengths in m, accelerations in m/s^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .parameters import VehicleParameters


def lateral_acceleration(speed: float, steering_angle: float, wheelbase: float) -> float:
    """Returns v^2 |tan delta| / L, the lateral acceleration (m/s^2) at the rear axle, unsigned."""
    return speed * speed * abs(math.tan(steering_angle)) / wheelbase


def safe_speed(steering_angle: float, parameters: VehicleParameters) -> float:
    """Returns the speed (m/s) at which the tyre angle (rad) meets the lateral acceleration limit.

    v_safe = sqrt(a_max L / |tan delta|); infinite with straight tyres.
    """
    slope = abs(math.tan(steering_angle))
    if slope == 0.0:
        return math.inf
    return math.sqrt(parameters.lateral_acceleration_limit * parameters.wheelbase / slope)


@dataclass(frozen=True)
class VelocityController:
    """Comfort controller; it keeps no state between commands.

    The margin belongs to the controller: speed lags steering, so a limiter at the boundary itself
    would let the vehicle cross it even without any delay of the commands.
    """

    parameters: VehicleParameters

    def command(self, measured_angle: float, commanded_angle: float, remaining: float) -> float:
        """Returns the speed to ask for, m/s.

        Args:
            measured_angle: Tyre angle reported by the vehicle, rad.
            commanded_angle: Tyre angle last asked for by the steering controller, rad; it tells
                where the measured angle is about to go.
            remaining: Length to the path's end, m. The last metres are driven at a speed in
                proportion to it, so that the vehicle comes to rest at the end; at and behind the
                end the answer is 0.
        """
        parameters = self.parameters
        safe = min(safe_speed(measured_angle, parameters), safe_speed(commanded_angle, parameters))
        return min(
            parameters.reference_speed,
            parameters.comfort_margin * safe,
            parameters.stopping_gain * max(remaining, 0.0),
        )
