"""Lines between the same two boxes: `dot` winds some around each other, which are drawn apart."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise, product
from math import dist

from jausml.views.diagrams.layout.settling import Area, area_of
from jausml.views.diagrams.layout.sheet import Line, Places, Point, Route, Sheet, on_curve, samples

_Path = tuple[Point, Point, Point, Point]

APART = 12
"""Room between two lines of the same boxes."""

_END_POSITIONS = (0.15, 0.3, 0.5, 0.7, 0.85)
"""Where on the side of a box another route may begin or end, as parts of its length."""


def with_parallels_apart(sheet: Sheet, places: Places) -> dict[str, Route]:
    """Returns the routes of all lines, of which one of each two that come too near is another.

    Both stay where there is no room. Only lines between the same two boxes are compared.
    """
    areas = {box.id: area_of(box, places.boxes[box.id]) for box in sheet.boxes}
    lines = dict(places.lines)
    beside: dict[frozenset[str], list[Line]] = defaultdict(list)
    for line in sheet.lines:
        source, target = line.source[0], line.target[0]
        if source != target:
            beside[frozenset((source, target))].append(line)
    pairs = (pair for bundle in beside.values() for pair in combinations(bundle, 2))
    # Once: a third line of the same boxes may still come near.
    for one, other in pairs:
        if nearness(lines[one.id], lines[other.id]) < APART:
            for line, kept in ((one, other), (other, one)):
                route = _another(line, lines[kept.id], areas, lines)
                if route is not None:
                    lines[line.id] = route
                    break
    return lines


def nearness(one: Route, other: Route) -> float:
    """Returns how near two routes come to each other."""
    return min(dist(*pair) for pair in product(samples(one.points), samples(other.points)))


def _another(
    line: Line, kept: Route, areas: Mapping[str, Area], lines: Mapping[str, Route]
) -> Route | None:
    """Returns the route over the fewest lines that is apart from `kept` and through no box."""
    others = [samples(kept_route.points) for name, kept_route in lines.items() if name != line.id]
    candidates: list[tuple[int, float, Route]] = []
    for points in _paths(areas[line.source[0]], areas[line.target[0]]):
        x, y = on_curve(points, 0.5)
        label = (round(x, 1), round(y, 1)) if lines[line.id].label is not None else None
        route, path = Route(points, label), samples(points)
        if not _hits_a_box(path, areas) and nearness(route, kept) >= APART:
            crossed = sum(_do_cross(path, other) for other in others)
            candidates.append((crossed, dist(points[0], points[-1]), route))
    best = min(candidates, key=lambda candidate: candidate[:2], default=None)
    return None if best is None else best[2]


def _hits_a_box(path: Sequence[Point], areas: Mapping[str, Area]) -> bool:
    return any(
        area.left < x < area.right and area.top < y < area.bottom
        for area in areas.values()
        for x, y in path
    )


def _paths(source: Area, target: Area) -> Iterator[_Path]:
    """Yields simple routes between boxes above or beside each other."""
    yield from _vertical(source, target)
    for path in _vertical(source.transposed, target.transposed):
        a, b, c, d = ((x, y) for y, x in path)
        yield a, b, c, d


def _vertical(source: Area, target: Area) -> Iterator[_Path]:
    """Yields routes between boxes of which one is above the other."""
    if source.bottom < target.top:
        y0, y1 = source.bottom, target.top
    elif target.bottom < source.top:
        y0, y1 = source.top, target.bottom
    else:
        return
    middle = round((y0 + y1) / 2, 1)
    for a, b in product(_END_POSITIONS, repeat=2):
        x0 = round(source.left + a * (source.right - source.left), 1)
        x1 = round(target.left + b * (target.right - target.left), 1)
        yield (x0, y0), (x0, middle), (x1, middle), (x1, y1)


def _do_cross(one: Sequence[Point], other: Sequence[Point]) -> bool:
    return any(_do_segments_cross(*a, *b) for a in pairwise(one) for b in pairwise(other))


def _do_segments_cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    # Each has the ends of the other on both sides.
    return _side(a, b, c) * _side(a, b, d) < 0 and _side(c, d, a) * _side(c, d, b) < 0


def _side(start: Point, end: Point, point: Point) -> float:
    """Returns a number whose sign is the side of a line on which a point is."""
    return (end[0] - start[0]) * (point[1] - start[1]) - (end[1] - start[1]) * (point[0] - start[0])
