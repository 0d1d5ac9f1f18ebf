"""Layout in columns, as one would draw by hand: what is joined stands level, lines go straight.

Boxes and rows keep the order that they come in. Each frame is arranged by itself, then moves as
one; parts that nothing joins, and the frames of crowded sheets, stand beside each other.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt

from jausml.views.diagrams.layout.lanes import routes_in
from jausml.views.diagrams.layout.levelling import Item, Link, levelled
from jausml.views.diagrams.layout.settling import FRAME_MARGIN, MOST, chain, surrounding
from jausml.views.diagrams.layout.sheet import Box, Frame, Line, Places, Point, Sheet
from jausml.views.diagrams.layout.ways import fitted

_LANE, _ROOM = 80, 28
"""Room between columns without labels, and beside each label."""

_SLOPED, _MOST_SLOPED = 10, 120
"""More room for each line that is not level, and for all of them at most."""

FRAME_GAP = 60
"""Room between what stands beside each other."""

_FEW_PARTS = 2  # parts that stand above each other

_ASPECT = 1.6
_WIDER = (1, 1.1, 1.25, 1.5)


@dataclass(frozen=True)
class Block:
    """Some boxes that keep their places beside each other: corners from the corner of all."""

    width: float
    height: float
    corners: Mapping[str, Point]


def in_columns(sheet: Sheet) -> Places:
    """Returns where everything stands."""
    corners = corners_in_columns(sheet)
    lines = routes_in(sheet, corners)
    frames = {
        name: ((area.left, area.top), (area.right, area.bottom))
        for name, area in surrounding(sheet, corners, lines).items()
    }
    return fitted(sheet, Places(0, 0, corners, frames, lines))


def corners_in_columns(sheet: Sheet) -> dict[str, Point]:
    """Returns where boxes stand alone, for who draws the lines himself."""
    return dict(_Work(sheet).content("").corners)


class _Work:
    def __init__(self, sheet: Sheet) -> None:
        self._sheet = sheet
        self._boxes = {box.id: box for box in sheet.boxes}
        self._parents = {frame.id: frame.parent for frame in sheet.frames}
        self._own: dict[str, list[Box]] = defaultdict(list)
        self._frames: dict[str, list[Frame]] = defaultdict(list)
        for box in sheet.boxes:
            self._own[box.group].append(box)
        for frame in sheet.frames:
            self._frames[frame.parent].append(frame)
        self._middles = {
            (b.id, row): down for b in sheet.boxes for row, down in b.middles().items()
        }
        self._told = {box.id: number for number, box in enumerate(sheet.boxes)}
        self._lines_from: dict[str, list[Line]] = defaultdict(list)
        for line in sheet.lines:
            self._lines_from[line.source[0]].append(line)
        self._linked = {end[0] for line in sheet.lines for end in (line.source, line.target)}

    def content(self, frame: str) -> Block:
        """Returns the block with the contents of a frame, or of the whole sheet."""
        if self._sheet.packed and self._frames[frame]:
            inner = [
                block for inner_frame in self._frames[frame] for block in self._framed(inner_frame)
            ]
            loose = [box for box in self._own[frame] if box.id not in self._linked]
            rest = [box for box in self._own[frame] if box.id in self._linked]
            return packed([*inner, *([self._grid(rest, frame)] if rest else ()),
                           *(self._grid([box], frame) for box in loose)])  # fmt: skip
        if frame or self._sheet.packed:
            return self._grid(self._own[frame], frame)
        parts = self._parts()
        if not parts:
            return Block(0, 0, {})
        if len(parts) <= _FEW_PARTS:
            return self._grid(self._sheet.boxes, "")
        return packed([self._grid([b for b in self._sheet.boxes if b.id in part], "")
                       for part in parts])  # fmt: skip

    def _framed(self, frame: Frame) -> Iterable[Block]:
        inner = self.content(frame.id)
        if inner.corners:
            left, top = FRAME_MARGIN, FRAME_MARGIN + frame.height
            width = max(inner.width, frame.width) + 2 * FRAME_MARGIN
            yield Block(width, top + inner.height + FRAME_MARGIN, _moved(inner, left, top))

    def _parts(self) -> list[Collection[str]]:
        """Returns the ids of boxes by parts that no line and no frame joins."""
        whole = {box.id: {box.id} for box in self._sheet.boxes}
        first: dict[str, str] = {}
        pairs = [(line.source[0], line.target[0]) for line in self._sheet.lines]
        for box in self._sheet.boxes:
            for outer in chain(box.group, self._parents):
                pairs.append((box.id, first.setdefault(outer, box.id)))
        for one, other in pairs:
            if whole[one] is not whole[other]:
                joined = whole[one] | whole[other]
                whole |= dict.fromkeys(joined, joined)
        return list({id(part): part for part in whole.values()}.values())

    def _grid(self, boxes: Sequence[Box], frame: str) -> Block:
        """Returns boxes in columns, and the frames among them that stand in a frame."""
        names = {box.id for box in boxes}
        lines = [
            line for box in boxes for line in self._lines_from[box.id] if line.target[0] in names
        ]
        item = self._item(frame, names, lines)
        lefts, width = self._lefts(boxes, lines, item.tops)
        return Block(
            width, item.height, {box.id: (lefts[box.id], item.tops[box.id]) for box in boxes}
        )

    def _item(self, frame: str, names: Collection[str], lines: Sequence[Line]) -> Item:
        """Returns the contents of a frame as one item that can be moved."""
        items = [
            Item({box.id: 0}, box.height, (box.column, box.column))
            for box in self._own[frame]
            if box.id in names
        ]
        for inner_frame in self._frames[frame]:
            inner = self._item(inner_frame.id, names, lines)
            if inner.tops:
                items.append(inner.framed(FRAME_MARGIN, inner_frame.height))
        items.sort(key=lambda item: min(self._told[name] for name in item.tops))
        return levelled(items, [self._link(line) for line in lines])

    def _link(self, line: Line) -> Link:
        one, other = line.source, line.target
        is_arc = self._boxes[one[0]].column == self._boxes[other[0]].column
        return Link(one[0], other[0], self._middles[one], self._middles[other], is_arc)

    def _lefts(
        self, boxes: Sequence[Box], lines: Sequence[Line], tops: Mapping[str, float]
    ) -> tuple[dict[str, float], float]:
        """Returns how far from the left boxes stand, and the width of all."""
        columns: dict[int, list[Box]] = defaultdict(list)
        for box in boxes:
            columns[box.column].append(box)
        numbers = sorted(columns)
        widths = {number: max(box.width for box in columns[number]) for number in numbers}
        at = {numbers[0]: 0.0}
        for number, following in pairwise(numbers):
            at[following] = at[number] + widths[number] + self._lane(number, following, lines, tops)
        lefts = {}
        for number in numbers:
            side = self._side(number, numbers, lines)
            for box in columns[number]:
                lefts[box.id] = at[number] + round((widths[number] - box.width) * side)
        return lefts, at[numbers[-1]] + widths[numbers[-1]]

    def _side(self, column: int, columns: Sequence[int], lines: Sequence[Line]) -> float:
        """Returns where boxes stand in their column: 0 at the left, 1 at the right.

        That is where most lines end.
        """
        if column not in (columns[0], columns[-1]):
            return 0.5
        ends = [
            {self._boxes[end[0]].column for end in (line.source, line.target)} for line in lines
        ]
        arcs = sum(end == {column} for end in ends)
        is_inside = arcs < sum(column in end and len(end) > 1 for end in ends)
        return float(is_inside == (column == columns[0] != columns[-1]))

    def _lane(
        self, left: int, right: int, lines: Sequence[Line], tops: Mapping[str, float]
    ) -> float:
        """Returns the room between two columns.

        It has room for labels that come to stand beside each other: those of lines of the same
        rows, and the widest two where lines are not level.
        """
        bundles: dict[frozenset[tuple[str, str]], float] = defaultdict(float)
        widths, sloped, bent = [0, 0], 0, False
        for line in lines:
            columns = sorted(self._boxes[end[0]].column for end in (line.source, line.target))
            bent |= columns == [left, left] and bool(left)
            if columns == [left, right]:
                one, other = (
                    tops[end[0]] + self._middles[end] for end in (line.source, line.target)
                )
                sloped += abs(one - other) >= 1
                wide = line.width + _ROOM if line.width else 0
                bundles[frozenset((line.source, line.target))] += wide
                widths.append(wide)
        labels = max(sum(sorted(widths)[-2:]) if sloped else max(widths), *bundles.values(), 0)
        margins = 2 * FRAME_MARGIN * bool(self._sheet.frames)
        return max(_LANE, labels) + min(_SLOPED * sloped, _MOST_SLOPED) + margins + MOST * bent


def _moved(block: Block, right: float, down: float) -> dict[str, Point]:
    return {name: (x + right, y + down) for name, (x, y) in block.corners.items()}


def packed(blocks: Sequence[Block]) -> Block:
    """Returns blocks on shelves, tall ones first, as wide as a screen is."""
    area = sum((block.width + FRAME_GAP) * (block.height + FRAME_GAP) for block in blocks)
    least = max(sqrt(area * _ASPECT), *(block.width for block in blocks), 0)
    # A shelf that just lacks room for one more would leave half of the screen bare.
    tried = [_shelved(blocks, least * factor) for factor in _WIDER]
    return min(tried, key=lambda block: max(block.width / _ASPECT, block.height))


def _shelved(blocks: Sequence[Block], widest: float) -> Block:
    corners: dict[str, Point] = {}
    left = top = height = width = 0.0
    for block in sorted(blocks, key=lambda candidate: -candidate.height):
        if left and left + block.width > widest:
            left, top, height = 0, top + height + FRAME_GAP, 0
        corners |= _moved(block, left, top)
        left += block.width + FRAME_GAP
        width, height = max(width, left - FRAME_GAP), max(height, block.height)
    return Block(width, top + height, corners)
