"""What an operator says about a drive: where the vehicle is, and how the drive has ended.

All of it follows from the reports themselves: where the vehicle was, and when it says that it was
there. When reports come says nothing, since a busy computer lets them wait and come together.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .path import StraightArcStraight

PROGRESS_EVERY = 10
"""Reports of the vehicle's pose for each line of progress."""

STANDSTILL = 0.05
"""Metres that a vehicle moves at most while it stands."""

REST = 0.5
"""Seconds between reports of the same place after which the vehicle stands."""

STUCK = 5.0
"""Seconds after which a vehicle that stands short of its goal is spoken of."""

UNDER_WAY = 1.0
"""Metres from the start from which on a vehicle has begun its drive."""

SHORT = 2.0
"""Metres along the path that may be left, or passed, at the goal."""

ASIDE = 5.0
"""Metres beside the path at the goal: tyres that slip end more than two metres aside, and how far
off a drive ends is for the path error to judge."""


def is_at_goal(path: StraightArcStraight, x: float, y: float) -> bool:
    """Returns whether a position (m, ROS axes) is at the end of a path."""
    nearest = path.nearest(x, y)
    return abs(path.length - nearest.station) < SHORT and abs(nearest.cross_track_error) < ASIDE


class Progress:
    """Follows the poses that the vehicle reports and those that the controller estimates.

    Positions are metres, in the JAUS axes in which they are reported.
    """

    def __init__(self, path: StraightArcStraight) -> None:
        """Begins before the first report.

        Args:
            path: Its end is the goal.
        """
        self._path = path
        self._estimate: tuple[float, float] | None = None
        self._last: tuple[float, float, float] | None = None
        self._rest: tuple[float, float, float] | None = None
        self._reports = 0
        self._moved = self._arrived = self._is_stuck = False

    def take_estimate(self, x: float, y: float) -> None:
        """Keeps the position that the controller has integrated."""
        self._estimate = x, y

    def take_position(self, x: float, y: float, sensed: float) -> list[str]:
        """Takes a report; returns the lines that are to be said.

        Args:
            x: True position forward, m.
            y: True position to the right, m.
            sensed: When the vehicle was there, s on its own clock.
        """
        if self._last is not None and sensed <= self._last[2]:
            return []  # an older report, or the same once more
        lines = []
        self._reports += 1
        if self._reports % PROGRESS_EVERY == 0:
            lines.append(self._said(x, y, sensed))
        self._last = x, y, sensed
        self._moved = self._moved or math.hypot(x, y) > UNDER_WAY
        if self._rest is None or math.dist(self._rest[:2], (x, y)) > STANDSTILL:
            self._rest, self._is_stuck = self._last, False
        elif self._moved and not self._arrived:
            lines += self._standing(x, y, sensed - self._rest[2])
        return lines

    def _standing(self, x: float, y: float, seconds: float) -> list[str]:
        """Returns what is to be said of a vehicle that has been at a place for some seconds."""
        if seconds >= REST and is_at_goal(self._path, x, -y):
            self._arrived = True
            return [f"arrived at x {x:.2f} m, y {y:.2f} m"]
        if seconds >= STUCK and not self._is_stuck:
            self._is_stuck = True
            left = self._path.remaining(x, -y)
            return [f"stands at x {x:.2f} m, y {y:.2f} m, {left:.1f} m from the end of its path"]
        return []

    def _said(self, x: float, y: float, sensed: float) -> str:
        said = [f"vehicle at x {x:6.2f} m, y {y:6.2f} m (JAUS axes)"]
        if self._last is not None:
            speed = math.dist(self._last[:2], (x, y)) / (sensed - self._last[2])
            said.append(f"{speed:4.1f} m/s")
        if self._estimate is not None:
            said.append(f"estimate off by {math.dist((x, y), self._estimate):.2f} m")
        return ", ".join(said)
