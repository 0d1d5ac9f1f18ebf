"""Input and output of a layout engine: sizes in, places out, in pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import accumulate
from typing import Literal

Point = tuple[float, float]
Course = Literal["", "down", "left", "right"]


class LayoutError(Exception):
    """There is no layout: the engine is missing or failed. The message says which."""


@dataclass(frozen=True)
class Row:
    """A row of a box at which lines end."""

    id: str
    height: int


@dataclass(frozen=True)
class Box:
    """A box to be placed.

    `group`: id of its frame, empty for none. `column`: from the left; on a sheet that goes
    downwards, 0 for a box above the others of its frame.
    """

    id: str
    width: int
    head: int
    rows: tuple[Row, ...]
    group: str
    column: int

    @cached_property
    def height(self) -> int:
        """Its height."""
        return self.head + sum(row.height for row in self.rows)

    def middles(self) -> dict[str, float]:
        """Returns the distance from its top to the middle of each row; of its head by no name."""
        tops = self.tops()
        rows = {row.id: tops[row.id] + row.height / 2 for row in self.rows}
        return {"": self.head / 2, **rows}

    def tops(self) -> dict[str, int]:
        """Returns the distance from its top to each row."""
        heights = accumulate((row.height for row in self.rows), initial=self.head)
        return {row.id: top for row, top in zip(self.rows, heights, strict=False)}


@dataclass(frozen=True)
class Frame:
    """A frame around boxes.

    `parent`: id of the frame around it, empty for none.
    """

    id: str
    parent: str
    width: int
    height: int


@dataclass(frozen=True)
class Line:
    """A line to be drawn.

    `course`: `down` for one that ends at the head of a box, `left` or `right` for one to a box
    beside that where it begins; empty for any.
    """

    id: str
    source: tuple[str, str]
    target: tuple[str, str]
    width: int = 0
    height: int = 0
    course: Course = ""


@dataclass(frozen=True)
class Sheet:
    """The boxes, frames and lines to place.

    `frames`: the frames, outer ones first.
    """

    boxes: tuple[Box, ...]
    frames: tuple[Frame, ...]
    lines: tuple[Line, ...]
    downwards: bool = False
    packed: bool = False


@dataclass(frozen=True)
class Route:
    """The way of a line.

    `label`: the middle of its label, None without one.
    """

    points: tuple[Point, ...]
    label: Point | None


_SAMPLES = 12  # points of a curve, between which it is taken as straight


@lru_cache(maxsize=1 << 14)
def samples(points: tuple[Point, ...]) -> list[Point]:
    """Returns points on a way of cubic Bezier curves, which are not to be changed."""
    sampled_points = list(points[:1])
    for at in range(0, len(points) - 3, 3):
        curve = points[at : at + 4]
        sampled_points += [on_curve(curve, step / _SAMPLES) for step in range(1, _SAMPLES + 1)]
    return sampled_points


def on_curve(points: Sequence[Point], part: float) -> Point:
    """Returns a point of a cubic Bezier curve."""
    rest = 1 - part
    weights = rest**3, 3 * part * rest**2, 3 * part * part * rest, part**3
    x, y = (
        sum(weight * point[axis] for weight, point in zip(weights, points, strict=True))
        for axis in (0, 1)
    )
    return x, y


@dataclass(frozen=True)
class Places:
    """Where everything stands; y grows downwards.

    `boxes`: upper left corners by id. `frames`: upper left and lower right corners by id.
    """

    width: float
    height: float
    boxes: dict[str, Point]
    frames: dict[str, tuple[Point, Point]]
    lines: dict[str, Route]

    def moved(self, right: float, down: float) -> Places:
        """Returns the same further right and down, as large as before."""
        if not right and not down:
            return self

        def to(point: Point) -> Point:
            return round(point[0] + right, 1), round(point[1] + down, 1)

        return replace(
            self,
            boxes={name: to(corner) for name, corner in self.boxes.items()},
            frames={name: (to(one), to(other)) for name, (one, other) in self.frames.items()},
            lines={
                name: Route(tuple(map(to, route.points)), to(route.label) if route.label else None)
                for name, route in self.lines.items()
            },
        )
