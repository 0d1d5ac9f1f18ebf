"""The prescribed path: a straight, an arc and a straight, with nearest-point queries.

ROS convention: x forward, y left, angles counter-clockwise; metres and radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .parameters import VehicleParameters


@dataclass(frozen=True)
class Pose:
    """Position x, y in metres and yaw psi in radians (counter-clockwise from the x axis)."""

    x: float = 0.0
    y: float = 0.0
    psi: float = 0.0

    def ahead(self, distance: float) -> Pose:
        """Returns the pose `distance` metres ahead; one wheelbase ahead lies the front axle."""
        return Pose(
            self.x + distance * math.cos(self.psi), self.y + distance * math.sin(self.psi), self.psi
        )


@dataclass(frozen=True)
class PathPoint:
    """The point of a path that is nearest to a position.

    Attributes:
        station: Length along the path from its start, m. Negative before the start and more than
            the path's length behind its end, where the straights are taken to go on.
        pose: Point on the path (m) and heading of the path there (rad).
        cross_track_error: Signed distance from the path to the position, m; positive left of the
            path.
    """

    station: float
    pose: Pose
    cross_track_error: float


def wrap_angle(angle: float) -> float:
    """Returns the angle (rad) within [-pi, pi]."""
    return math.remainder(angle, math.tau)


@dataclass(frozen=True)
class _Line:
    start: Pose
    first_station: float

    def nearest(self, x: float, y: float, lowest: float, highest: float) -> PathPoint:
        """Project on the line, with the run from its start (m) held within [lowest, highest]."""
        dx, dy = x - self.start.x, y - self.start.y
        cosine, sine = math.cos(self.start.psi), math.sin(self.start.psi)
        run = min(max(dx * cosine + dy * sine, lowest), highest)
        foot = self.start.ahead(run)
        side = dy * cosine - dx * sine
        distance = math.hypot(x - foot.x, y - foot.y)
        return PathPoint(self.first_station + run, foot, math.copysign(distance, side))


@dataclass(frozen=True)
class _Arc:
    start: Pose
    first_station: float
    radius: float
    turn: float

    def at(self, run: float) -> Pose:
        """Returns the pose `run` metres along the arc."""
        side = math.copysign(1.0, self.turn)
        psi = self.start.psi + side * run / self.radius
        return Pose(
            self.start.x + side * self.radius * (math.sin(psi) - math.sin(self.start.psi)),
            self.start.y - side * self.radius * (math.cos(psi) - math.cos(self.start.psi)),
            psi,
        )

    def nearest(self, x: float, y: float) -> PathPoint:
        """Project on the arc, held within its ends."""
        side = math.copysign(1.0, self.turn)
        centre_x = self.start.x - side * self.radius * math.sin(self.start.psi)
        centre_y = self.start.y + side * self.radius * math.cos(self.start.psi)
        # Angles are measured from the middle of the arc, so that the seam of atan2 lies opposite to
        # it.
        middle = self.start.psi + self.turn / 2
        bearing = math.atan2(y - centre_y, x - centre_x) + side * math.pi / 2
        angle = side * wrap_angle(bearing - middle) + abs(self.turn) / 2
        run = self.radius * min(max(angle, 0.0), abs(self.turn))
        foot = self.at(run)
        outside = math.hypot(x - centre_x, y - centre_y) - self.radius
        distance = math.hypot(x - foot.x, y - foot.y)
        return PathPoint(self.first_station + run, foot, math.copysign(distance, side * -outside))


@dataclass(frozen=True)
class StraightArcStraight:
    """A straight, an arc and a straight, from the origin along the x axis.

    Attributes:
        approach: Length of the first straight, m.
        radius: Radius of the arc, m.
        turn: Angle of the arc, rad; negative to the right, as yaw is counter-clockwise.
        departure: Length of the last straight, m.

    Raises:
        ValueError: A length or the radius is not positive or finite, or the turn is zero or above a
            half circle.
    """

    approach: float
    radius: float
    turn: float
    departure: float
    _first: _Line = field(init=False, repr=False, compare=False)
    _arc: _Arc = field(init=False, repr=False, compare=False)
    _last: _Line = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Place the three pieces one after the other."""
        lengths = (self.approach, self.radius, self.departure)
        if not all(math.isfinite(length) and length > 0.0 for length in lengths):
            raise ValueError(f"lengths and radius of a path must be positive, got {lengths}")
        if not 0.0 < abs(self.turn) <= math.pi:
            raise ValueError(
                f"turn must be a half circle at most and not zero, got {self.turn} rad"
            )
        first = _Line(Pose(), 0.0)
        arc = _Arc(Pose().ahead(self.approach), self.approach, self.radius, self.turn)
        arc_length = self.radius * abs(self.turn)
        last = _Line(arc.at(arc_length), self.approach + arc_length)
        # The dataclass is frozen; these are derived from its fields once and never change.
        object.__setattr__(self, "_first", first)
        object.__setattr__(self, "_arc", arc)
        object.__setattr__(self, "_last", last)

    @classmethod
    def right_turn(cls, parameters: VehicleParameters) -> StraightArcStraight:
        """Returns the path of the scenario: heading 0, a right turn, heading -90 degrees."""
        straight = parameters.straight_length
        return cls(straight, parameters.turn_radius, -math.pi / 2, straight)

    @property
    def length(self) -> float:
        """Length of the whole path, m."""
        return self._last.first_station + self.departure

    def at(self, station: float) -> Pose:
        """Returns point (m) and heading (rad) of the path `station` metres from its start."""
        if station < self._arc.first_station:
            return self._first.start.ahead(station)
        if station < self._last.first_station:
            return self._arc.at(station - self._arc.first_station)
        return self._last.start.ahead(station - self._last.first_station)

    def nearest(self, x: float, y: float) -> PathPoint:
        """Returns the path point nearest to the position (m).

        The straights go on beyond the path's ends, so that behind the end the cross-track error is
        still the distance across the path and the station still grows.
        """
        candidates = (
            self._first.nearest(x, y, -math.inf, self.approach),
            self._arc.nearest(x, y),
            self._last.nearest(x, y, 0.0, math.inf),
        )
        return min(candidates, key=lambda point: abs(point.cross_track_error))

    def cross_track_error(self, x: float, y: float) -> float:
        """Returns the signed distance (m) from path to position; positive left of the path."""
        return self.nearest(x, y).cross_track_error

    def remaining(self, x: float, y: float) -> float:
        """Returns the length (m) from the nearest path point to the end; negative behind it."""
        return self.length - self.nearest(x, y).station

    def points(self, spacing: float) -> list[Pose]:
        """Returns poses from start to end, equally spaced by `spacing` metres at most."""
        count = max(1, math.ceil(self.length / spacing))
        return [self.at(self.length * index / count) for index in range(count + 1)]
