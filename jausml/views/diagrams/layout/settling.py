"""Places in a drawing that changes: what stands stays, new boxes find room, frames surround.

An engine places a whole sheet anew whatever changed; this finds room for single boxes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

from jausml.views.diagrams.layout.sheet import Box, Frame, Line, Point, Route, Sheet, samples

GAP, COLUMN_GAP = 24, 80
"""Room between boxes below and beside each other."""

FRAME_MARGIN = 12
"""Room between a frame and what stands in it."""

_APART = 4  # room between a frame that has grown by its lines and what stands beside it

_CELL = 512


class Area(NamedTuple):
    """A rectangle."""

    left: float
    top: float
    right: float
    bottom: float

    def overlaps(self, other: Area, gap: float = 0) -> bool:
        """Tells whether two areas have a common point, or less room than a gap between them."""
        return (
            self.left < other.right + gap
            and other.left < self.right + gap
            and self.top < other.bottom + gap
            and other.top < self.bottom + gap
        )

    def around(self, other: Area) -> Area:
        """Returns the least rectangle around both."""
        return Area(
            min(self.left, other.left),
            min(self.top, other.top),
            max(self.right, other.right),
            max(self.bottom, other.bottom),
        )

    @property
    def transposed(self) -> Area:
        """The area with right and down exchanged."""
        return Area(self.top, self.left, self.bottom, self.right)

    def wider(self, gap: float) -> Area:
        """Returns the area with room around it."""
        return Area(self.left - gap, self.top - gap, self.right + gap, self.bottom + gap)


def area_of(box: Box, corner: Point) -> Area:
    """Returns the area of a box."""
    left, top = corner
    return Area(left, top, left + box.width, top + box.height)


def settle(
    sheet: Sheet, known: Mapping[str, Point], fixed: Collection[str] = ()
) -> dict[str, Point]:
    """Returns where the boxes of a sheet stand.

    Boxes of known places stay there, unless one that has grown covers them: then they go as far as
    they must. Others come beside boxes to which lines lead, where nothing stands. `known`: upper
    left corners of boxes by id. `fixed`: ids of the known boxes that never move.
    """
    ground = _Ground(sheet)
    for box in sheet.boxes:
        if box.id in known and box.id in fixed:
            ground.put(box, known[box.id])
    movable_boxes = [box for box in sheet.boxes if box.id in known and box.id not in fixed]
    for box in sorted(
        movable_boxes, key=lambda placed_box: (known[placed_box.id][::-1], placed_box.id)
    ):
        corner = known[box.id]
        ground.put(box, corner if ground.is_bare(box, corner) else ground.nearest(box, corner))
    new = [box for box in sheet.boxes if box.id not in known]
    while new:
        box = next((new_box for new_box in new if ground.peers(new_box)), new[0])
        new.remove(box)
        # What is joined with nothing comes behind what there is, and never before it.
        is_last = not ground.peers(box)
        ground.put(box, ground.nearest(box, ground.beside(box), is_last=is_last))
    return {box.id: ground.corners[box.id] for box in sheet.boxes}


def frames_around(
    sheet: Sheet, boxes: Mapping[str, Point], more: Mapping[str, Iterable[Area]] | None = None
) -> dict[str, Area]:
    """Returns the areas of frames for placed boxes; those around nothing are left out.

    `boxes`: upper left corners of boxes by id; of those that stand already.
    """
    inner: dict[str, Area] = {}
    for name, areas in (more or {}).items():
        for area in areas:
            _widen(inner, name, area)
    for box in sheet.boxes:
        if box.id in boxes:
            _widen(inner, box.group, area_of(box, boxes[box.id]))
    areas_by_frame: dict[str, Area] = {}
    for frame in reversed(sheet.frames):
        if frame.id in inner:
            areas_by_frame[frame.id] = _framed(frame, inner[frame.id])
            _widen(inner, frame.parent, areas_by_frame[frame.id])
    return areas_by_frame


def _widen(areas: dict[str, Area], name: str, area: Area) -> None:
    areas[name] = areas[name].around(area) if name in areas else area


def _framed(frame: Frame, inner: Area) -> Area:
    left, top = inner.left - FRAME_MARGIN, inner.top - FRAME_MARGIN - frame.height
    right = max(inner.right + FRAME_MARGIN, left + frame.width + 2 * FRAME_MARGIN)
    return Area(left, top, right, inner.bottom + FRAME_MARGIN)


@dataclass(frozen=True)
class _End:
    """A box that stands, and the height at which a line ends there."""

    box: Box
    y: float


class _Ground:
    """The boxes that stand already, and the room between them."""

    def __init__(self, sheet: Sheet) -> None:
        self._sheet = sheet
        self._boxes = {box.id: box for box in sheet.boxes}
        self._parents = {frame.id: frame.parent for frame in sheet.frames}
        self._has_columns = not sheet.downwards and len({b.column for b in sheet.boxes}) > 1
        self._areas: dict[str, Area] = {}
        self._cells: dict[tuple[int, int], list[Area]] = defaultdict(list)
        self._frames: dict[str, Area] = {}
        self.corners: dict[str, Point] = {}

    def put(self, box: Box, corner: Point) -> None:
        """Places a box."""
        self.corners[box.id] = corner
        area = self._areas[box.id] = area_of(box, corner)
        for cell in tiles(area):
            self._cells[cell].append(area)
        self._frames = {}

    def peers(self, box: Box) -> list[_End]:
        """Returns where the lines of a box end at boxes that stand."""
        ends = []
        for line in self._sheet.lines:
            for (own, _), (other, row) in ((line.source, line.target), (line.target, line.source)):
                if own == box.id != other and other in self.corners:
                    ends.append(_End(self._boxes[other], self._row(self._boxes[other], row)))
        return ends

    def _row(self, box: Box, row: str) -> float:
        down = box.middles().get(row) if row else None
        return self.corners[box.id][1] + (box.height / 2 if down is None else down)

    def beside(self, box: Box) -> Point:
        """Returns where a box would stand best, if nothing stood there."""
        peers = self.peers(box)
        column = [self._areas[column_box.id] for column_box in self._column(box)]
        if not peers:
            among = column or list(self._areas.values())
            if not among:
                return 0, 0
            lowest = max(among, key=lambda area: area.bottom)
            left = _centred(box, lowest) if column and self._has_columns else lowest.left
            return left, lowest.bottom + GAP
        y = sum(end.y for end in peers) / len(peers) - box.height / 2
        peer = self._areas[peers[0].box.id]
        if not self._has_columns:
            return peer.right + COLUMN_GAP, peer.top
        if column:
            near = min(column, key=lambda area: abs((area.top + area.bottom - box.height) / 2 - y))
            return _centred(box, near), y
        if box.column < peers[0].box.column:
            return peer.left - COLUMN_GAP - box.width, y
        return peer.right + COLUMN_GAP, y

    def _column(self, box: Box) -> list[Box]:
        """Returns the boxes in the column of a box, in its frame if there are others.

        All are in one column where there are no others.
        """
        same = [
            column_box
            for column_box in self._sheet.boxes
            if column_box.id in self.corners
            and (column_box.column == box.column or not self._has_columns)
        ]
        return [column_box for column_box in same if column_box.group == box.group] or same

    def nearest(self, box: Box, wanted: Point, *, is_last: bool = False) -> Point:
        """Returns the place above or below one that is wanted, where a box has room.

        `is_last`: only below.
        """
        x, y = wanted
        frames = self._all_frames()
        tops = [y]
        for area in (*self._areas.values(), *frames.values()):
            for gap in (GAP, GAP + 2 * FRAME_MARGIN):
                tops += [area.bottom + gap, area.top - gap - box.height]
        for top in sorted(tops, key=lambda candidate: (abs(candidate - y), -candidate)):
            if (top >= y or not is_last) and self._has_room(box, (x, top)):
                return round(x), round(top)
        lowest = max(area.bottom for area in (*self._areas.values(), *frames.values()))
        return round(x), round(lowest + GAP)

    def is_bare(self, box: Box, corner: Point) -> bool:
        """Tells whether the place of a box is free of other boxes."""
        area = area_of(box, corner)
        return not any(
            area.overlaps(other_area)
            for cell in tiles(area)
            for other_area in self._cells.get(cell, ())
        )

    def _has_room(self, box: Box, corner: Point) -> bool:
        """Tells whether a box has room, and the frames around it, which grow with it."""
        area = area_of(box, corner)
        if any(area.overlaps(other_area, GAP - 1) for other_area in self._areas.values()):
            return False
        around = set(self._around(box.group))
        frames = self._all_frames()
        others = (frame_area for name, frame_area in frames.items() if name not in around)
        if any(area.overlaps(other, FRAME_MARGIN) for other in others):
            return False
        grown = frames_around(self._sheet, {**self.corners, box.id: corner})
        return not any(
            grown[name].overlaps(area)
            for name in around
            if grown.get(name) != frames.get(name)
            for area in self._outside(name, frames)
        )

    def _outside(self, frame: str, frames: Mapping[str, Area]) -> Iterator[Area]:
        """Yields the areas that stand neither in a frame nor around it."""
        for name, area in self._areas.items():
            if frame not in self._around(self._boxes[name].group):
                yield area
        around = set(self._around(frame))
        for name, area in frames.items():
            if name not in around and frame not in self._around(name):
                yield area

    def _around(self, group: str) -> Iterator[str]:
        return chain(group, self._parents)

    def _all_frames(self) -> dict[str, Area]:
        if not self._frames:
            self._frames = frames_around(self._sheet, self.corners)
        return self._frames


def tiles(area: Area, size: float = _CELL) -> Iterator[tuple[int, int]]:
    """Yields the cells of a grid with a part of an area: overlapping areas share one."""
    for column in range(int(area.left // size), int(area.right // size) + 1):
        for row in range(int(area.top // size), int(area.bottom // size) + 1):
            yield column, row


_Cells = defaultdict[tuple[int, int], set[str]]
"""The names of the areas that have a part in each cell."""


def _note(cells: _Cells, name: str, area: Area) -> None:
    for cell in tiles(area):
        cells[cell].add(name)


def _near(cells: _Cells, area: Area) -> set[str]:
    """Returns the names of areas that share a cell with an area."""
    return set().union(*(cells[cell] for cell in tiles(area) if cell in cells))


def _centred(box: Box, other: Area) -> float:
    return (other.left + other.right - box.width) / 2


LEAST, STEEP, MOST = 24, 0.15, 90
"""How far a line bends outwards between boxes above each other; the page draws it so."""


def surrounding(
    sheet: Sheet, corners: Mapping[str, Point], routes: Mapping[str, Route | None]
) -> dict[str, Area]:
    """Returns the areas of frames.

    A frame is as wide as the lines that begin and end in it, unless it would cover something that
    stands elsewhere. `corners`: upper left corners of boxes by id. `routes`: ways of lines by id,
    None for lines that a page draws from end to end.
    """
    boxes = {box.id: box for box in sheet.boxes}
    parents = {sheet_frame.id: sheet_frame.parent for sheet_frame in sheet.frames}
    grown = frames_around(sheet, corners)
    chains = {box.id: tuple(chain(box.group, parents)) for box in sheet.boxes}
    more: dict[str, list[Area]] = {}
    for line in sheet.lines:
        source, target = chains[line.source[0]], chains[line.target[0]]
        frame = next((ancestor for ancestor in source if ancestor in target), "")
        if frame:
            route = routes[line.id]
            between = () if route is not None else _bent(line, boxes, corners)
            more.setdefault(frame, []).extend(covered(line, route) if route else between)
    areas = {box.id: area_of(box, corners[box.id]) for box in sheet.boxes}
    cells, frame_cells = _Cells(set), _Cells(set)
    for name, area in areas.items():
        _note(cells, name, area)
    for name, area in grown.items():
        _note(frame_cells, name, area)
    frames = {sheet_frame.id: sheet_frame for sheet_frame in sheet.frames}
    for frame, line_areas in more.items():
        framed = [_framed(frames[frame], line_area) for line_area in line_areas]
        reach = reduce(Area.around, framed, grown[frame]).wider(_APART)
        outside = [areas[name] for name in _near(cells, reach) if frame not in chains[name]]
        around = set(chain(frame, parents))
        outside += [
            grown[name]
            for name in _near(frame_cells, reach)
            if name not in around and frame not in chain(name, parents)
        ]
        outside = [area for area in outside if area.overlaps(reach)]
        more[frame] = [
            line_area
            for line_area, around_it in zip(line_areas, framed, strict=True)
            if not any(around_it.overlaps(other, _APART) for other in outside)
        ]
        # What grows later shall not cover this one.
        for area in more[frame]:
            inner = area
            for name in chain(frame, parents):
                inner = _framed(frames[name], inner)
                before, grown[name] = grown[name], grown[name].around(inner)
                if grown[name] != before:
                    _note(frame_cells, name, grown[name])
    return frames_around(sheet, corners, more)


def chain(group: str, parents: Mapping[str, str]) -> Iterator[str]:
    """Yields a frame and those around it, the innermost first."""
    while group:
        yield group
        group = parents.get(group, "")


def covered(line: Line, route: Route) -> Iterator[Area]:
    """Yields the areas of the way of a line, and of its label."""
    xs, ys = zip(*samples(route.points), strict=True)
    yield Area(min(xs), min(ys), max(xs), max(ys))
    if route.label is not None:
        yield label_area(line, route.label)


def label_area(line: Line, middle: Point) -> Area:
    """Returns the area of the label of a line."""
    x, y = middle
    right, down = line.width / 2, line.height / 2
    return Area(x - right, y - down, x + right, y + down)


def _bent(line: Line, boxes: Mapping[str, Box], corners: Mapping[str, Point]) -> Iterator[Area]:
    """Yields the area of a line that a page draws, none where it stays between its boxes."""
    source, target = boxes[line.source[0]], boxes[line.target[0]]
    one, other = area_of(source, corners[source.id]), area_of(target, corners[target.id])
    if one.right <= other.left or other.right <= one.left:
        return
    both = one.around(other)
    far = 0.75 * min(LEAST + STEEP * (both.bottom - both.top), MOST)
    if source.column == target.column == 0:
        yield Area(min(one.left, other.left) - far, both.top, both.left, both.bottom)
    else:
        yield Area(both.right, both.top, max(one.right, other.right) + far, both.bottom)
