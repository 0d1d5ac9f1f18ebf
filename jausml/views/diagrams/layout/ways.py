"""Ways that keep their distance: ends off corners, frames around all, no line on another.

`dot` aims at middles of boxes, which may lie behind their corners, and leads lines through frames.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

from jausml.views.diagrams.layout.parallel import with_parallels_apart
from jausml.views.diagrams.layout.settling import Area, area_of, covered, surrounding
from jausml.views.diagrams.layout.sheet import Places, Point, Sheet

OFF_CORNERS = 16
"""Room between a corner and the end of a line: corners may be round, and arrowheads are wide.

Each side of a box is longer than twice that, since a line of text and its margins are.
"""


def spaced(sheet: Sheet, places: Places) -> Places:
    """Returns places of which lines and frames keep their distance."""
    areas = {box.id: area_of(box, places.boxes[box.id]) for box in sheet.boxes}
    lines = {}
    for line in sheet.lines:
        route = places.lines[line.id]
        points = list(route.points)
        for at, (name, _) in ((0, line.source), (-1, line.target)):
            points[at] = _off_corners(areas[name], points[at])
        lines[line.id] = replace(route, points=tuple(points))
    lines = with_parallels_apart(sheet, replace(places, lines=lines))
    frames = surrounding(sheet, places.boxes, lines)
    return fitted(
        sheet,
        replace(
            places,
            frames={
                name: ((area.left, area.top), (area.right, area.bottom))
                for name, area in frames.items()
            },
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
        places, width=round(whole.right - whole.left, 1), height=round(whole.bottom - whole.top, 1)
    )
    return size.moved(-whole.left, -whole.top)


def _off_corners(area: Area, end: Point) -> Point:
    """Returns an end further along the border where it is."""
    x, y = end
    from_sides = min(abs(x - area.left), abs(x - area.right))
    if min(abs(y - area.top), abs(y - area.bottom)) <= from_sides:
        return _within(x, area.left, area.right), y
    return x, _within(y, area.top, area.bottom)


def _within(value: float, first: float, last: float) -> float:
    return min(max(value, first + OFF_CORNERS), last - OFF_CORNERS)
