"""Frames around what goes on in them: boxes, and the lines between boxes of one frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.views.diagrams.layout.settling import FRAME_MARGIN, Area, area_of, frames_around

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.views.diagrams.layout.sheet import Box, Line, Point, Route, Sheet

_LEAST, _STEEP, _MOST = 24, 0.15, 90
"""How far a line bends outwards between boxes above each other; the page draws it so."""

_SAMPLES = 8


def surrounding(
    sheet: Sheet, corners: Mapping[str, Point], routes: Mapping[str, Route | None]
) -> dict[str, Area]:
    """Returns what frames cover.

    A frame is as wide as the lines that begin and end in it, unless it would cover something that
    stands elsewhere.

    Args:
        corners: Upper left corners of boxes by id.
        routes: Ways of lines by id, None for lines that a page draws from end to end.
    """
    boxes = {each.id: each for each in sheet.boxes}
    parents = {each.id: each.parent for each in sheet.frames}
    plain = frames_around(sheet, corners)
    chains = {each.id: tuple(_chain(each.group, parents)) for each in sheet.boxes}
    more: dict[str, list[Area]] = {}
    for line in sheet.lines:
        source, target = chains[line.source[0]], chains[line.target[0]]
        frame = next((each for each in source if each in target), "")
        area = _covered(line, boxes, corners, routes[line.id]) if frame else None
        if area is not None:
            more.setdefault(frame, []).append(area)
    areas = {each.id: area_of(each, corners[each.id]) for each in sheet.boxes}
    for frame, found in more.items():
        others = [area for name, area in areas.items() if frame not in chains[name]]
        around = set(_chain(frame, parents))
        others += [
            area
            for name, area in plain.items()
            if name not in around and frame not in _chain(name, parents)
        ]
        more[frame] = [each for each in found if not _is_in_the_way(each, others)]
    return frames_around(sheet, corners, more)


def _chain(group: str, parents: Mapping[str, str]) -> Iterator[str]:
    """Yields a frame and those around it, the innermost first."""
    while group:
        yield group
        group = parents.get(group, "")


def _is_in_the_way(area: Area, others: list[Area]) -> bool:
    return any(area.overlaps(each, FRAME_MARGIN) for each in others)


def _covered(
    line: Line, boxes: Mapping[str, Box], corners: Mapping[str, Point], route: Route | None
) -> Area | None:
    """Returns what a line covers, None where it stays between its boxes."""
    if route is not None:
        xs, ys = zip(*_points(route.points), strict=True)
        return Area(min(xs), min(ys), max(xs), max(ys))
    source, target = boxes[line.source[0]], boxes[line.target[0]]
    one, other = area_of(source, corners[source.id]), area_of(target, corners[target.id])
    if one.right <= other.left or other.right <= one.left:
        return None
    both = one.around(other)
    far = 0.75 * min(_LEAST + _STEEP * (both.bottom - both.top), _MOST)
    if source.column == target.column == 0:
        return Area(min(one.left, other.left) - far, both.top, both.left, both.bottom)
    return Area(both.right, both.top, max(one.right, other.right) + far, both.bottom)


def _points(route: tuple[Point, ...]) -> Iterator[Point]:
    """Yields points on a way of cubic Bezier curves."""
    yield route[0]
    for at in range(0, len(route) - 3, 3):
        curve = route[at : at + 4]
        for step in range(1, _SAMPLES + 1):
            t = step / _SAMPLES
            weights = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3
            x, y = (
                sum(w * point[axis] for w, point in zip(weights, curve, strict=True))
                for axis in (0, 1)
            )
            yield x, y
