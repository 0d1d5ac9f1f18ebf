"""The steering controller: the Hoffmann (Stanley) law at the front axle.

ROS convention: the tyre angle is positive to the left; metres, seconds, radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .path import Pose, StraightArcStraight, wrap_angle

if TYPE_CHECKING:
    from .parameters import VehicleParameters


def hoffmann_angle(
    pose: Pose, speed: float, path: StraightArcStraight, parameters: VehicleParameters
) -> float:
    """Returns the tyre angle (rad) that leads the front axle back to the path.

    delta = (psi_path - psi) - atan2(k e, v), where e is the cross-track error of the front axle,
    positive left of the path. Law: G. Hoffmann et al., "Autonomous Automobile Trajectory Tracking
    for Off-Road Driving", ACC 2007; gain as in the CAT Vehicle's public follower. Evaluating it at
    the front axle and the smallest speed are assumptions of this example.

    Args:
        pose: Pose of the rear axle, m and rad.
        speed: Measured speed, m/s.
        path: The path to follow.
        parameters: Wheelbase, gain, speed floor and steering limit are used.

    Returns:
        Tyre angle, rad, within the steering limit; negative steers right.
    """
    front = pose.ahead(parameters.wheelbase)
    target = path.nearest(front.x, front.y)
    pull = math.atan2(
        parameters.steering_gain * target.cross_track_error,
        max(speed, parameters.steering_speed_floor),
    )
    angle = wrap_angle(target.pose.psi - pose.psi) - pull
    return min(max(angle, -parameters.steering_limit), parameters.steering_limit)


@dataclass(frozen=True)
class SteeringController:
    """The steering law bound to its path; it keeps no state between commands.

    Attributes:
        parameters: Parameters of the controller, which need not be those of the plant.
        path: The path to follow.
    """

    parameters: VehicleParameters
    path: StraightArcStraight

    def command(self, pose: Pose, speed: float) -> float:
        """Returns the tyre angle (rad) for a pose of the rear axle (m, rad) and a speed (m/s)."""
        return hoffmann_angle(pose, speed, self.path, self.parameters)
