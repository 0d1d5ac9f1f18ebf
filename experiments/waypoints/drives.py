"""The lists that are driven, and what happens on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Point = tuple[float, float]

LIMIT = 60.0
"""Seconds in which a list must have ended."""
WATCHED = 2.0
"""Seconds in which the robot is watched after it should have stopped."""
STOP_TIME = 1.0
"""Seconds after an emergency in which the robot must stand: the wheels need five times their lag of
0.15 s, and the rest is for the way of the emergency to them, three processes."""
CONTROL_TIMEOUT = 5.0
"""Seconds after which the robot takes its operator for lost, as both models say."""


@dataclass(frozen=True)
class Drive:
    """A list, and what happens on the way.

    Attributes:
        name: Its name.
        waypoints: Where they are, m, in ROS axes: x forward, y left of the start.
        emergency_at: Element on the way to which there is an emergency; None for none.
        lost_at: Element on the way to which the radio of the operator is lost, likewise.
    """

    name: str
    waypoints: tuple[Point, ...]
    emergency_at: int | None = None
    lost_at: int | None = None

    @property
    def plan(self) -> dict[str, Any]:
        """What the operator is told; JAUS has y to the right."""
        return {
            "waypoints": [[x, -y] for x, y in self.waypoints],
            "emergency_at": self.emergency_at,
        }

    @property
    def stops_in(self) -> float:
        """Seconds in which the robot must stand after what happens on the way."""
        return STOP_TIME if self.lost_at is None else CONTROL_TIMEOUT + STOP_TIME


LIST: tuple[Point, ...] = (
    (2.0, 0.0),
    (4.0, 1.5),
    (6.0, 0.0),
    (6.0, -2.5),
    (4.0, -3.5),
    (2.0, -2.0),
    (0.0, -2.0),
    (0.0, 0.0),
)
WHOLE = Drive("whole", LIST)
EMERGENCY = Drive("emergency", LIST, emergency_at=3)
LOST = Drive("lost", LIST, lost_at=3)
SHORT = Drive("whole", ((1.0, 0.0), (1.8, -0.8)))
