"""Layout of boxes whose rows face each other: two columns, and lines straight across.

Nothing has to be searched for here: rows keep their order, so that a column alone is moved up or
down until lines are as level as they can be, and labels stand beside each other on their lines.
"""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import TYPE_CHECKING

from jausml.views.diagrams.layout.settling import GAP, Area, label_area
from jausml.views.diagrams.layout.sheet import Places, Route, on_curve
from jausml.views.diagrams.layout.ways import fitted

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.views.diagrams.layout.sheet import Box, Line, Point, Sheet

_LEAST_LANE, _ROOM = 140, 36
"""Room between the columns without labels, and beside each label."""

_APART = 7
"""Between lines of the same two rows."""

_PARTS = tuple(0.5 + step / 50 * side for step in range(21) for side in (-1, 1))
"""Where labels may stand on their lines."""


def can_face(sheet: Sheet) -> bool:
    """Tells whether all stands in two columns, without frames, with lines only between them."""
    columns = {box.id: box.column for box in sheet.boxes}
    return (
        sheet.facing
        and not sheet.frames
        and len(set(columns.values())) == 2
        and all(columns[line.source[0]] != columns[line.target[0]] for line in sheet.lines)
    )


def face(sheet: Sheet) -> Places:
    """Returns where everything stands."""
    work = _Work(sheet)
    corners = work.corners()
    return fitted(sheet, Places(0, 0, corners, {}, work.routes(corners)))


class _Work:
    """One layout."""

    def __init__(self, sheet: Sheet) -> None:
        self._sheet = sheet
        self._left = min(box.column for box in sheet.boxes)
        self._boxes = {box.id: box for box in sheet.boxes}
        self._rows = {(box.id, row): y for box in sheet.boxes for row, y in box.middles().items()}
        self._bundles = self._bundled()

    def _bundled(self) -> list[list[Line]]:
        """Returns the lines of the same two rows, those to the right first."""
        bundles: dict[frozenset[tuple[str, str]], list[Line]] = defaultdict(list)
        for line in self._sheet.lines:
            bundles[frozenset((line.source, line.target))].append(line)
        return [sorted(bundle, key=self._goes_left) for bundle in bundles.values()]

    def _goes_left(self, line: Line) -> bool:
        return self._boxes[line.source[0]].column != self._left

    def corners(self) -> dict[str, Point]:
        """Returns the upper left corners of boxes."""
        columns: tuple[list[Box], list[Box]] = ([], [])
        for box in self._sheet.boxes:
            columns[box.column != self._left].append(box)
        tops = {box.id: top for column in columns for box, top in _stacked(column)}
        steps = [self._step(line, tops) for line in self._sheet.lines]
        # Of most lines: one from the last row to the first shall not tilt all others.
        down = round(median(steps)) if steps else 0
        widest = max(box.width for box in columns[0])
        right = widest + self._lane()
        corners = {box.id: (float(widest - box.width), tops[box.id]) for box in columns[0]}
        return corners | {box.id: (float(right), tops[box.id] + down) for box in columns[1]}

    def _step(self, line: Line, tops: dict[str, float]) -> float:
        """Returns how far the right end of a line stands above the left one."""
        ends = [tops[end[0]] + self._rows[end] for end in (line.source, line.target)]
        return ends[1] - ends[0] if self._goes_left(line) else ends[0] - ends[1]

    def _lane(self) -> int:
        """Returns the room between the columns: for labels that come to stand beside each other.

        Those are the labels of lines of the same rows, and the widest two where lines cross.
        """
        widths = sorted(line.width + _ROOM for line in self._sheet.lines if line.width)
        wide = (sum(line.width + _ROOM for line in bundle) for bundle in self._bundles)
        return max(_LEAST_LANE, sum(widths[-2:]), *wide)

    def routes(self, corners: dict[str, Point]) -> dict[str, Route]:
        """Returns the ways of lines.

        `corners`: upper left corners of boxes.
        """
        curves, wishes = {}, []
        for bundle in self._bundles:
            for index, line in enumerate(bundle):
                aside = _APART * (index - (len(bundle) - 1) / 2)
                curves[line.id] = self._points(line, corners, aside)
                share = (index + 0.5) / len(bundle)
                wishes.append((line, 1 - share if self._goes_left(line) else share, aside))
        labels: dict[str, Point | None] = {}
        taken: list[Area] = []
        # Wide ones first: short ones find room between them.
        for line, wanted, aside in sorted(wishes, key=lambda wish: -wish[0].width):
            labels[line.id] = _label(line, curves[line.id], wanted, aside, taken)
        return {line: Route(way, labels[line]) for line, way in curves.items()}

    def _points(
        self, line: Line, corners: dict[str, Point], aside: float
    ) -> tuple[Point, Point, Point, Point]:
        """Returns a curve that leaves and reaches its rows level."""
        ends = []
        for end in (line.source, line.target):
            box = self._boxes[end[0]]
            x, y = corners[box.id]
            is_left = box.column == self._left
            ends.append((x + box.width if is_left else x, y + self._rows[end] + aside))
        (x0, y0), (x1, y1) = ends
        half = (x1 - x0) / 2
        return (x0, y0), (x0 + half, y0), (x1 - half, y1), (x1, y1)


def _stacked(boxes: Sequence[Box]) -> Iterable[tuple[Box, float]]:
    """Yields boxes and their tops, one below the other."""
    at = 0.0
    for box in boxes:
        yield box, at
        at += box.height + GAP


def _label(
    line: Line,
    points: tuple[Point, Point, Point, Point],
    wanted: float,
    aside: float,
    taken: list[Area],
) -> Point | None:
    """Returns the middle of a label, where it covers no other if there is such a place.

    Args:
        wanted: Where on it the label stands best, 0 to 1.
        aside: How far below the line it stands, lest it covers another of the same rows.
        taken: What labels cover already; this one comes to it.
    """
    if not line.width:
        return None
    positions = [on_curve(points, part) for part in (wanted, *_PARTS)]
    places = [(round(x, 1), round(y, 1) + aside) for x, y in positions]
    areas = [label_area(line, place) for place in places]
    free = (at for at, area in enumerate(areas) if not any(area.overlaps(t) for t in taken))
    chosen = next(free, 0)
    taken.append(areas[chosen])
    return places[chosen]
