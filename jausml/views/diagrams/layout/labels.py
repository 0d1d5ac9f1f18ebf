"""Labels that hide nothing: each goes along its line to where it lies on nothing else.

An engine makes room for labels in ranks, but leads other lines through there, and puts labels
between boxes of one rank on each other.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, product
from math import dist
from typing import Literal, TypeAlias

from jausml.views.diagrams.layout.settling import Area, area_of, label_area, tiles
from jausml.views.diagrams.layout.sheet import Line, Places, Point, Route, Sheet, samples
from jausml.views.diagrams.layout.ways import fitted

_TEXTS, _OTHERS = 10, 3
"""How much a box or a label counts that is hidden, and a line of others; its own counts as one."""

_TIP = 5  # pixels around the end of a line that belong to its arrowhead

_BESIDE = (0.5, 4)
"""Pixels between a line and a label beside it: if it is level, and if it bends there."""

_FROM_OTHERS = 1.4
"""Pixels between a label and lines of others, which shall be farther away than its own."""

_TILE = 48  # size of the tiles in which lines are looked for

_Tile = tuple[int, int]
_Segment: TypeAlias = "tuple[Point, Point]"
Anchor = Literal["start", "middle", "end"]

_OFF = 5  # pixels from its line at which a label seems to belong to none


def cleared(sheet: Sheet, places: Places) -> Places:
    """Returns places of which labels lie on no other part, where their lines have room for that.

    The picture becomes as large as all that stands on it.
    """
    ground = Ground(sheet, places)
    for line in sheet.lines:
        ground.clear(line)
    lines = {
        name: replace(route, label=ground.labels.get(name)) for name, route in places.lines.items()
    }
    return fitted(sheet, replace(places, lines=lines))


def hidden(sheet: Sheet, places: Places) -> int:
    """Returns how much all labels hide, or come too near to, as `Ground.hidden` counts it."""
    ground = Ground(sheet, places)
    return sum(ground.hidden(line, middle) for line, middle in ground.labels.items())


class Ground:
    """The ground for labels: boxes, borders and titles of frames, lines, and other labels."""

    def __init__(self, sheet: Sheet, places: Places) -> None:
        self.labels = {name: route.label for name, route in places.lines.items() if route.label}
        self._lines = {line.id: line for line in sheet.lines}
        self._paths = {name: samples(route.points) for name, route in places.lines.items()}
        self._segments: dict[_Tile, list[tuple[str, _Segment]]] = defaultdict(list)
        for name, way in self._paths.items():
            for segment in pairwise(way):
                for tile in tiles(_around(segment), _TILE):
                    self._segments[tile].append((name, segment))
        self._boxes = [area_of(box, places.boxes[box.id]) for box in sheet.boxes]
        self._thin = [
            Area(x - _TIP, y - _TIP, x + _TIP, y + _TIP)
            for x, y in (way[-1] for way in self._paths.values() if way)
        ]
        for frame in sheet.frames:
            (left, top), (right, bottom) = places.frames[frame.id]
            self._thin += _borders(Area(left, top, right, bottom))
            self._thin.append(Area(left, top, left + frame.width, top + frame.height))

    def clear(self, line: Line) -> None:
        """Moves a label to another place if it hides a part of the picture."""
        wanted = self.labels.get(line.id)
        if wanted is None or not self.hidden(line.id, wanted):
            return
        # Nearest first, and of equal ones the first: the same for the same sheet.
        places = sorted(self._candidates(line), key=lambda candidate: dist(candidate, wanted))
        least = self.hidden(line.id, wanted)
        for place in places:
            overlap = self.hidden(line.id, place)
            if overlap < least:
                least, self.labels[line.id] = overlap, place
            if not least:
                return

    def hidden(self, line: str, middle: Point) -> int:
        """Returns how much the label of a line would hide, or come too near to.

        Texts count more than what can be followed beneath a label; one that stands off its line
        counts as if it hid something.
        """
        area = self.area(line, middle)
        others = [self.area(name, centre) for name, centre in self.labels.items() if name != line]
        text_overlap = _TEXTS * sum(map(area.overlaps, (*self._boxes, *others)))
        return (
            text_overlap
            + sum(map(area.overlaps, self._thin))
            + sum(1 if name == line else _OTHERS for name in self._entering(line, area))
            + (not _enters(self._paths[line], area.wider(_OFF)))
        )

    def _entering(self, line: str, area: Area) -> set[str]:
        """Returns the lines that are in an area, or nearly so, which is that of a label."""
        near = area.wider(_FROM_OTHERS)
        return {
            name
            for tile in tiles(near, _TILE)
            for name, segment in self._segments.get(tile, ())
            if _crosses(segment, area if name == line else near)
        }

    def area(self, line: str, middle: Point) -> Area:
        """Returns the area of the label of a line."""
        return label_area(self._lines[line], middle)

    def _candidates(self, line: Line) -> Iterator[Point]:
        for x, y in self._paths[line.id]:
            for gap in _BESIDE:
                right, down = line.width / 2 + gap, line.height / 2 + gap
                for across, along in product((0, -right, right), (0, -down, down)):
                    yield round(x + across, 1), round(y + along, 1)


def anchored(room: Area, width: float, route: Route) -> tuple[Anchor, float]:
    """Returns how a text stands in the room of a label, which may be wider, and at which x.

    In its middle if its line leads by there, else at the `start` or `end` of the room.
    """
    middle = (room.left + room.right) / 2
    sides: list[tuple[Anchor, float, float]] = [
        ("middle", middle, middle - width / 2),
        ("start", room.left, room.left),
        ("end", room.right, room.right - width),
    ]
    for anchor, x, left in sides:
        text = Area(left, room.top, left + width, room.bottom)
        if _enters(samples(route.points), text.wider(_OFF)):
            return anchor, x
    return "middle", middle


def _borders(area: Area) -> Iterator[Area]:
    left, top, right, bottom = area
    yield Area(left, top, right, top)
    yield Area(left, bottom, right, bottom)
    yield Area(left, top, left, bottom)
    yield Area(right, top, right, bottom)


def _around(segment: _Segment) -> Area:
    (x, y), (a, b) = segment
    return Area(min(x, a), min(y, b), max(x, a), max(y, b))


def _enters(way: Sequence[Point], area: Area) -> bool:
    return any(_crosses(segment, area) for segment in pairwise(way))


def _crosses(segment: _Segment, area: Area) -> bool:
    (x, y), (a, b) = segment
    if max(x, a) <= area.left or min(x, a) >= area.right:
        return False
    if max(y, b) <= area.top or min(y, b) >= area.bottom:
        return False
    sides = [
        (a - x) * (down - y) - (b - y) * (across - x)
        for across in (area.left, area.right)
        for down in (area.top, area.bottom)
    ]
    return min(sides) < 0 < max(sides)
