"""Ways of lines between columns: straight where rows are level, bows between boxes of a column."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

from jausml.views.diagrams.layout.settling import LEAST, MOST, STEEP
from jausml.views.diagrams.layout.sheet import Box, Line, Point, Route, Sheet

_APART = 7  # between lines of the same two rows

_NESTED = 12  # between bows of which one is within the other

_BESIDE = 4  # between bows and their labels

_OFF_ENDS = 12  # between the ends of lines, which may have arrowheads, and labels

_LEVEL = 1  # pixels up or down that lines may lead which are drawn straight


def routes_in(sheet: Sheet, corners: Mapping[str, Point]) -> dict[str, Route]:
    """Returns the ways of lines, with labels beside them.

    `corners`: upper left corners of boxes.
    """
    return dict(_Work(sheet, corners).routes())


class _Work:
    def __init__(self, sheet: Sheet, corners: Mapping[str, Point]) -> None:
        self._corners = corners
        self._boxes = {box.id: box for box in sheet.boxes}
        self._downs = {(b.id, row): down for b in sheet.boxes for row, down in b.middles().items()}
        self._lines = sheet.lines
        self._first = min((box.column for box in sheet.boxes), default=0)

    def routes(self) -> Iterator[tuple[str, Route]]:
        """Yields lines and their ways."""
        bundles: dict[frozenset[tuple[str, str]], list[Line]] = defaultdict(list)
        bows = []
        for line in self._lines:
            one, other = self._box(line.source), self._box(line.target)
            if one.column == other.column:
                bows.append(line)
            else:
                bundles[frozenset((line.source, line.target))].append(line)
        for bundle in bundles.values():
            bundle.sort(
                key=lambda line: self._box(line.source).column > self._box(line.target).column
            )
            for index, line in enumerate(bundle):
                yield line.id, self._across(line, index, len(bundle))
        yield from self._bows(bows)

    def _box(self, end: tuple[str, str]) -> Box:
        return self._boxes[end[0]]

    def _height(self, end: tuple[str, str]) -> float:
        return self._corners[end[0]][1] + self._downs[end]

    def _across(self, line: Line, index: int, count: int) -> Route:
        """Returns a way from column to column, beside others of the same rows."""
        aside = _APART * (index - (count - 1) / 2)
        source, target = line.source, line.target
        is_right = self._box(source).column < self._box(target).column
        left, right = (source, target) if is_right else (target, source)
        x0, y0 = self._corners[left[0]][0] + self._box(left).width, self._height(left) + aside
        x1, y1 = self._corners[right[0]][0], self._height(right) + aside
        if abs(y1 - y0) <= _LEVEL:
            y1 = y0
        half = (x1 - x0) / 2
        points = ((x0, y0), (x0 + half, y0), (x1 - half, y1), (x1, y1))
        label = None
        if line.width and count > 1:
            # Beside each other: those to the right first.
            share = (count - index - 0.5) / count if not is_right else (index + 0.5) / count
            label = x0 + share * (x1 - x0), y0 + share * (y1 - y0) + aside
        elif line.width:
            label = self._above(line, x0, y0, x1, y1)
        return Route(points if is_right else points[::-1], _rounded(label))

    def _above(self, line: Line, x0: float, y0: float, x1: float, y1: float) -> Point:
        """Returns the place above a line: at its middle, or its higher end if it slopes."""
        up = line.height / 2
        if y0 == y1:
            return (x0 + x1) / 2, y0 - up - _LEVEL / 2
        if y0 < y1:
            return x0 + _OFF_ENDS + line.width / 2, y0 - up
        return x1 - _OFF_ENDS - line.width / 2, y1 - up

    def _bows(self, lines: Sequence[Line]) -> Iterator[tuple[str, Route]]:
        """Yields the ways from a side of a column back to it, shorter ones within longer ones."""
        spans: list[tuple[int, float, float, float]] = []
        for line in sorted(lines, key=lambda bow: abs(self._span(bow)[0] - self._span(bow)[1])):
            column = self._box(line.source).column
            sign = -1 if column == self._first else 1
            sides = [self._side(end, sign) for end in (line.source, line.target)]
            (top, bottom) = sorted(self._span(line))
            beside = [
                self._side((box.id, ""), sign)
                for box in self._boxes.values()
                if box.column == column
                and self._corners[box.id][1] < bottom
                and self._corners[box.id][1] + box.height > top
            ]
            far = max(side * sign for side in (*sides, *beside))
            far += min(LEAST + STEEP * (bottom - top), MOST)
            for its, upper, lower, reach in spans:
                if its == column and upper < bottom and top < lower:
                    far = max(far, reach + _NESTED)
            spans.append((column, top, bottom, far))
            y0, y1 = self._span(line)
            if y0 == y1:
                y0, y1 = y0 - _APART / 2, y1 + _APART / 2
            out = far * sign
            middle = (
                sum(sides) / 8 + 0.75 * out + sign * (_BESIDE + line.width / 2),
                (y0 + y1) / 2,
            )
            points = (sides[0], y0), (out, y0), (out, y1), (sides[1], y1)
            yield line.id, Route(points, _rounded(middle if line.width else None))

    def _span(self, line: Line) -> tuple[float, float]:
        return self._height(line.source), self._height(line.target)

    def _side(self, end: tuple[str, str], sign: int) -> float:
        x = self._corners[end[0]][0]
        return x if sign < 0 else x + self._box(end).width


def _rounded(point: Point | None) -> Point | None:
    return None if point is None else (round(point[0], 1), round(point[1], 1))
