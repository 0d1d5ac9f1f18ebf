"""The robot and how it follows waypoints, without ROS and JAUS: what all its programs share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

TRACK = 0.4
"""Metres between the wheels."""
FASTEST = 1.5
"""Largest speed of a wheel, m/s."""
LAG = 0.15
"""Time constant of the wheels, s."""
PERIOD = 0.02
"""Seconds between two steps."""
REACHED = 0.15
"""Distance in metres at which the robot has reached a waypoint."""
SPEED = 1.0
"""Largest speed, m/s."""
TURN = 2.0
"""Largest yaw rate, rad/s."""

COLUMNS = "real_s,x_m,y_m,psi_rad,v_m_s,yaw_rate_rad_s"
"""First line of a log of true states."""


@dataclass
class Body:
    """Pose of the middle of the axle and speeds of the wheels; x forward, y left of the start.

    Attributes:
        x: Metres.
        y: Metres.
        psi: Yaw, rad, counter-clockwise.
        left: Speed of the left wheel, m/s.
        right: Speed of the right wheel, m/s.
    """

    x: float = 0.0
    y: float = 0.0
    psi: float = 0.0
    left: float = 0.0
    right: float = 0.0

    @property
    def speed(self) -> float:
        """Forward speed, m/s."""
        return (self.left + self.right) / 2

    @property
    def yaw_rate(self) -> float:
        """Yaw rate, rad/s."""
        return (self.right - self.left) / TRACK

    def advance(self, speed: float, yaw_rate: float, seconds: float) -> None:
        """Moves on with a wanted speed (m/s) and yaw rate (rad/s), which the wheels follow."""
        share = 1 - math.exp(-seconds / LAG)
        turn = yaw_rate * TRACK / 2
        self.left += (_limited(speed - turn) - self.left) * share
        self.right += (_limited(speed + turn) - self.right) * share
        middle = self.psi + self.yaw_rate * seconds / 2
        self.x += self.speed * seconds * math.cos(middle)
        self.y += self.speed * seconds * math.sin(middle)
        self.psi += self.yaw_rate * seconds

    def row(self, time: float) -> str:
        """Returns its state as a line of a log."""
        state = (time, self.x, self.y, self.psi, self.speed, self.yaw_rate)
        return ",".join(map(str, state)) + "\n"


class Course:
    """Waypoints that are followed one after the other, as the waypoint follower of Nav2 does.

    The orientation of a waypoint is not looked at.

    Attributes:
        active: Which one the robot drives to, from 0; their count when all are reached.
    """

    def __init__(self, waypoints: Sequence[tuple[float, float]]) -> None:
        """Begins with the first one; x and y in m, y to the left."""
        self.active = 0
        self._waypoints = waypoints

    @property
    def is_over(self) -> bool:
        """Whether all are reached."""
        return self.active >= len(self._waypoints)

    def command(self, x: float, y: float, psi: float) -> tuple[float, float]:
        """Returns the speed (m/s) and the yaw rate (rad/s) for a pose; zeros at the end."""
        while not self.is_over and math.dist(self._waypoints[self.active], (x, y)) < REACHED:
            self.active += 1
        if self.is_over:
            return 0.0, 0.0
        is_last = self.active == len(self._waypoints) - 1
        return steer(x, y, psi, self._waypoints[self.active], is_last=is_last)


def steer(
    x: float, y: float, psi: float, goal: tuple[float, float], *, is_last: bool
) -> tuple[float, float]:
    """Returns the speed (m/s) and the yaw rate (rad/s) that lead to a waypoint.

    Args:
        x: Position of the robot, m.
        y: The same to the left.
        psi: Its yaw, rad.
        goal: The waypoint, m.
        is_last: Whether the robot shall stop there.
    """
    off = math.remainder(math.atan2(goal[1] - y, goal[0] - x) - psi, math.tau)
    yaw_rate = min(max(3.0 * off, -TURN), TURN)
    speed = SPEED * max(math.cos(off), 0.0) ** 3
    if is_last:
        speed = min(speed, math.dist(goal, (x, y)) + 0.1)
    return speed, yaw_rate


def _limited(speed: float) -> float:
    return min(max(speed, -FASTEST), FASTEST)
