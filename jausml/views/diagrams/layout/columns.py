"""Layout in columns: each frame by itself, and frames beside each other, also within frames.

In a frame with one bridge there is little to look for: what is joined with an upper row stands
above. Graphviz packs no frames that stand in others, and so makes one tall column of them.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING

from jausml.views.diagrams.layout.settling import FRAME_MARGIN, GAP, frames_around
from jausml.views.diagrams.layout.sheet import Places

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.views.diagrams.layout.sheet import Box, Frame, Line, Point, Sheet

LANE = 130
"""Room between columns, through which lines go."""

FRAME_GAP = 60
"""Room between frames."""

_ASPECT = 1.6
_WIDER = (1, 1.1, 1.25, 1.5)


@dataclass(frozen=True)
class Block:
    """Some boxes that keep their places beside each other: corners from the corner of all."""

    width: float
    height: float
    corners: Mapping[str, Point]


class Columns:
    """An engine that gives boxes and frames their places, and leaves the ways of lines open."""

    def place(self, sheet: Sheet) -> Places:
        """Returns where everything stands."""
        whole = _Work(sheet).content("")
        frames = frames_around(sheet, whole.corners)
        return Places(
            whole.width,
            whole.height,
            dict(whole.corners),
            {name: ((a.left, a.top), (a.right, a.bottom)) for name, a in frames.items()},
            {},
        )


class _Work:
    def __init__(self, sheet: Sheet) -> None:
        self._boxes: dict[str, list[Box]] = defaultdict(list)
        self._frames: dict[str, list[Frame]] = defaultdict(list)
        for box in sheet.boxes:
            self._boxes[box.group].append(box)
        for frame in sheet.frames:
            self._frames[frame.parent].append(frame)
        self._lines: dict[str, list[Line]] = defaultdict(list)
        for line in sheet.lines:
            for name in {line.source[0], line.target[0]}:
                self._lines[name].append(line)

    def content(self, frame: str) -> Block:
        """Returns what stands in a frame: columns, or frames and boxes side by side."""
        boxes = self._boxes[frame]
        inner = [
            block for inner_frame in self._frames[frame] for block in self._framed(inner_frame)
        ]
        if not inner:
            return self._columns(boxes)
        loose = [box for box in boxes if box.id not in self._lines]
        rest = self._columns([box for box in boxes if box.id in self._lines])
        return packed([*inner, *([rest] if rest.corners else ()), *map(_alone, loose)])

    def _framed(self, frame: Frame) -> Iterable[Block]:
        inner = self.content(frame.id)
        if inner.corners:
            left, top = FRAME_MARGIN, FRAME_MARGIN + frame.height
            width = max(inner.width, frame.width) + 2 * FRAME_MARGIN
            yield Block(width, top + inner.height + FRAME_MARGIN, _moved(inner, left, top))

    def _columns(self, boxes: Sequence[Box]) -> Block:
        """Returns boxes in their columns, each near the rows that it is joined with."""
        columns: dict[int, list[Box]] = defaultdict(list)
        for box in boxes:
            columns[box.column].append(box)
        # That of the most rows keeps its order, as bridges do.
        first = max(
            columns,
            key=lambda column_index: sum(len(b.rows) for b in columns[column_index]),
            default=0,
        )
        tops = _stacked(columns[first])
        for number, column in columns.items():
            if number != first:
                wanted = self._wanted(column, columns[first], tops)
                column.sort(key=lambda column_box: wanted[column_box.id])
        stacks = {number: _stacked(columns[number]) for number in sorted(columns)}
        heights = {
            number: max(
                (top[column_box.id] + column_box.height for column_box in columns[number]),
                default=0,
            )
            for number, top in stacks.items()
        }
        tallest = max(heights.values(), default=0)
        left, corners = 0.0, {}
        for number, top in stacks.items():
            width = max((column_box.width for column_box in columns[number]), default=0)
            down = round((tallest - heights[number]) / 2)
            for column_box in columns[number]:
                corners[column_box.id] = (
                    left + (width - column_box.width) // 2,
                    top[column_box.id] + down,
                )
            left += width + LANE
        return Block(max(0, left - LANE), tallest, corners)

    def _wanted(
        self, boxes: Sequence[Box], others: Sequence[Box], tops: Mapping[str, float]
    ) -> dict[str, float]:
        """Returns how high boxes would stand best, infinite for those that no line joins."""
        rows = {
            (box.id, row): tops[box.id] + down
            for box in others
            for row, down in box.middles().items()
        }
        return {box.id: self._middle(box.id, rows) for box in boxes}

    def _middle(self, box: str, rows: Mapping[tuple[str, str], float]) -> float:
        """Returns the middle of the rows to which the lines of a box lead."""
        heights = [
            rows[other]
            for line in self._lines.get(box, ())
            for end, other in ((line.source, line.target), (line.target, line.source))
            if end[0] == box and other in rows
        ]
        return sum(heights) / len(heights) if heights else float("inf")


def _alone(box: Box) -> Block:
    return Block(box.width, box.height, {box.id: (0, 0)})


def _moved(block: Block, right: float, down: float) -> dict[str, Point]:
    return {name: (x + right, y + down) for name, (x, y) in block.corners.items()}


def _stacked(boxes: Sequence[Box]) -> dict[str, float]:
    """Returns the tops of boxes, one below the other."""
    tops, at = {}, 0.0
    for box in boxes:
        tops[box.id] = at
        at += box.height + GAP
    return tops


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
