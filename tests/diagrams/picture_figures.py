"""What is wrong with a picture, in numbers: what one sees who would draw it by hand."""

from collections import defaultdict
from dataclasses import astuple, dataclass
from itertools import combinations, pairwise
from math import dist, hypot

from jausml.views.diagrams.layout.settling import area_of, label_area
from jausml.views.diagrams.layout.sheet import samples

HUMP = 4
"""Pixels that a line between two columns may leave the heights of its ends."""

OFF = 6
"""Pixels between a line and its label at most."""

TOGETHER, LONG = 3, 30
"""Pixels of two lines that run as one: from each other, and along."""

_CELL = 40
_TILE = 64


@dataclass(frozen=True)
class Figures:
    """Figures of one picture, or sums of several.

    Attributes:
        crossings: Pairs of lines that cross.
        humps: Lines between columns that swing beyond the heights of their ends.
        overlaps: Labels on boxes, labels or lines of others, and lines that run as one or through
            boxes.
        strays: Labels that stand off their line, or nearer to another one.
        unused: Cells of the picture with nothing in them.
        cells: All cells.
    """

    crossings: int = 0
    humps: int = 0
    overlaps: int = 0
    strays: int = 0
    unused: int = 0
    cells: int = 0

    def __add__(self, other):
        """Returns the sums."""
        return Figures(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))


def figures(sheet, places):
    """Returns the figures of a picture."""
    ways = {line.id: samples(places.lines[line.id].points) for line in sheet.lines}
    boxes = [area_of(box, places.boxes[box.id]) for box in sheet.boxes]
    labels = {
        line.id: label_area(line, places.lines[line.id].label)
        for line in sheet.lines
        if line.width and places.lines[line.id].label is not None
    }
    used = set()
    for area in (*boxes, *labels.values()):
        used |= set(_cells(area))
    used |= {(int(x // _CELL), int(y // _CELL)) for way in ways.values() for x, y in way}
    cells = (int(places.width // _CELL) + 1) * (int(places.height // _CELL) + 1)
    near = _near(ways)
    return Figures(
        sum(_cross(ways[one], ways[other]) for one, other in near),
        sum(_is_hump(sheet, line, ways[line.id]) for line in sheet.lines),
        _overlaps(ways, boxes, labels, near),
        sum(_is_stray(name, area, ways) for name, area in labels.items()),
        cells - len(used),
        cells,
    )


def _cells(area):
    for column in range(int(area.left // _CELL), int(area.right // _CELL) + 1):
        for row in range(int(area.top // _CELL), int(area.bottom // _CELL) + 1):
            yield column, row


def _near(ways):
    """Returns the pairs of lines of which segments are in one tile."""
    tiles = defaultdict(set)
    for name, way in ways.items():
        for (x, y), (a, b) in pairwise(way):
            for column in range(int(min(x, a) // _TILE), int(max(x, a) // _TILE) + 1):
                for row in range(int(min(y, b) // _TILE), int(max(y, b) // _TILE) + 1):
                    tiles[column, row].add(name)
    pairs = {pair for names in tiles.values() for pair in combinations(sorted(names), 2)}
    return sorted(pairs)


def _cross(one, other):
    """Tells whether two ways cross, not where they only begin or end together."""
    ends = [one[0], one[-1], other[0], other[-1]]
    return any(
        _is_crossed(*a, *b) and min(dist(a[0], end) for end in ends) > TOGETHER
        for a in pairwise(one)
        for b in pairwise(other)
    )


def _is_crossed(a, b, c, d):
    return _side(a, b, c) * _side(a, b, d) < 0 and _side(c, d, a) * _side(c, d, b) < 0


def _side(a, b, point):
    return (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])


def _is_hump(sheet, line, way):
    columns = {box.id: box.column for box in sheet.boxes}
    if sheet.downwards or columns[line.source[0]] == columns[line.target[0]]:
        return False
    ends = way[0][1], way[-1][1]
    return any(not min(ends) - HUMP <= y <= max(ends) + HUMP for _, y in way)


def _overlaps(ways, boxes, labels, near):
    hidden = sum(area.overlaps(box) for area in labels.values() for box in boxes)
    hidden += sum(a.overlaps(b) for a, b in combinations(labels.values(), 2))
    for name, way in ways.items():
        hidden += sum(_enters(way, area) for own, area in labels.items() if own != name)
        hidden += sum(_enters(way, box.wider(-2)) for box in boxes)
    return hidden + sum(_run_as_one(ways[one], ways[other]) for one, other in near)


def _enters(way, area):
    return any(area.left < x < area.right and area.top < y < area.bottom for x, y in _fine(way))


def _fine(way):
    for (x, y), (a, b) in pairwise(way):
        steps = int(hypot(a - x, b - y) // TOGETHER) + 1
        for step in range(steps):
            yield x + (a - x) * step / steps, y + (b - y) * step / steps


def _run_as_one(one, other):
    """Tells whether two ways are one for long, other than where they begin or end together."""
    ends = [one[0], one[-1], other[0], other[-1]]
    along = 0.0
    for a, b in pairwise(one):
        x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
        near = min(_to_segment((x, y), c, d) for c, d in pairwise(other))
        if near < TOGETHER and min(dist((x, y), end) for end in ends) > LONG:
            along += dist(a, b)
    return along > LONG


def _to_segment(point, start, end):
    across, down = end[0] - start[0], end[1] - start[1]
    square = across * across + down * down
    part = ((point[0] - start[0]) * across + (point[1] - start[1]) * down) / square if square else 0
    part = min(max(part, 0), 1)
    return hypot(point[0] - start[0] - part * across, point[1] - start[1] - part * down)


def _is_stray(name, area, ways):
    own = distance(area, ways[name])
    return own > OFF or any(distance(area, way) < own for key, way in ways.items() if key != name)


def distance(area, way):
    """Returns how far a way is from a label."""
    return min(
        hypot(max(area.left - x, x - area.right, 0), max(area.top - y, y - area.bottom, 0))
        for x, y in _fine(way)
    )
