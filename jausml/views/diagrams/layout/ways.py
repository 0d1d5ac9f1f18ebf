"""Ways that keep their distance: lines beside their boxes, ends off corners, frames around all.

`dot` squeezes what leads from one side of a column back to it between boxes and the border of
their frame, or through that; and aims at middles of boxes, which may lie behind their corners.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING

from jausml.views.diagrams.layout.parallel import parted
from jausml.views.diagrams.layout.settling import (
    LEAST,
    MOST,
    STEEP,
    Area,
    area_of,
    covered,
    surrounding,
)
from jausml.views.diagrams.layout.sheet import Places, Route, samples

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.views.diagrams.layout.sheet import Box, Line, Point, Sheet

OFF_CORNERS = 16
"""Room between a corner and the end of a line: corners may be round, and arrowheads are wide."""

_NEAR = 2
"""Pixels from a border at which a line still ends there."""


def spaced(sheet: Sheet, places: Places) -> Places:
    """Returns places of which lines and frames keep their distance."""
    areas = {box.id: area_of(box, places.boxes[box.id]) for box in sheet.boxes}
    boxes = {box.id: box for box in sheet.boxes}
    lines = {}
    for line in sheet.lines:
        route = _beside(line, boxes, areas, places.lines[line.id])
        points = list(route.points)
        for at, (name, row) in ((0, line.source), (-1, line.target)):
            if not row:
                points[at] = _off_corners(areas[name], points[at])
        lines[line.id] = replace(route, points=tuple(points))
    lines = parted(sheet, replace(places, lines=lines))
    frames = surrounding(sheet, places.boxes, lines)
    return fitted(
        sheet,
        replace(
            places,
            frames={name: ((a.left, a.top), (a.right, a.bottom)) for name, a in frames.items()},
            lines=lines,
        ),
    )


def fitted(sheet: Sheet, places: Places) -> Places:
    """Returns places on a picture that is just as large as all that stands on it."""
    areas = [area_of(box, places.boxes[box.id]) for box in sheet.boxes]
    areas += [Area(*one, *other) for one, other in places.frames.values()]
    areas += [area for line in sheet.lines for area in covered(line, places.lines[line.id])]
    whole = reduce(Area.around, areas) if areas else Area(0, 0, 0, 0)
    size = replace(
        places,
        width=round(whole.right - whole.left, 1),
        height=round(whole.bottom - whole.top, 1),
    )
    return size.moved(-whole.left, -whole.top)


def _beside(line: Line, boxes: Mapping[str, Box], areas: Mapping[str, Area], route: Route) -> Route:
    """Returns a way from a side of a column back to it, as pages draw it; any other as it is."""
    ends = [
        (areas[name], areas[name].top + boxes[name].middles()[row])
        for name, row in (line.source, line.target)
    ]
    for side, sign in ((0, -1), (2, 1)):
        xs = [area[side] for area, _ in ends]
        (x0, y0), (x1, y1) = start, end = (xs[0], ends[0][1]), (xs[1], ends[1][1])
        if ends[0][0] is ends[1][0] or not (
            _is_at(route.points[0], start) and _is_at(route.points[-1], end)
        ):
            continue
        out = max(xs, key=lambda coordinate: coordinate * sign) + sign * min(
            LEAST + STEEP * abs(y1 - y0), MOST
        )
        points = (x0, y0), (out, y0), (out, y1), (x1, y1)
        middle = round((x0 + x1) / 8 + 0.75 * out, 1), round((y0 + y1) / 2, 1)
        if not any(_enters(points, area) for area in areas.values()):
            return Route(points, middle if route.label is not None else None)
    return route


def _is_at(point: Point, other: Point) -> bool:
    return abs(point[0] - other[0]) <= _NEAR and abs(point[1] - other[1]) <= _NEAR


def _enters(points: tuple[Point, ...], area: Area) -> bool:
    left, top, right, bottom = area
    return any(left < x < right and top < y < bottom for x, y in samples(points))


def _off_corners(area: Area, end: Point) -> Point:
    """Returns an end further along the border where it is."""
    x, y = end
    from_sides = min(abs(x - area.left), abs(x - area.right))
    if min(abs(y - area.top), abs(y - area.bottom)) <= from_sides:
        return _within(x, area.left, area.right), y
    return x, _within(y, area.top, area.bottom)


def _within(value: float, first: float, last: float) -> float:
    room = min(OFF_CORNERS, (last - first) / 2)
    return min(max(value, first + room), last - room)
