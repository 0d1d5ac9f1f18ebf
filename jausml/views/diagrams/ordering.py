"""An order of boxes and rows in which few lines cross, and these are short.

Rows of systems may change places, and boxes of systems and maps: rows of messages have the order of
what they show. Exact search is too dear; boxes and rows go to the mean of what they are joined with
(their barycenter), then neighbours change places as long as that helps.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import TypeVar

from jausml.views.diagrams.graph import Graph, Node

_ROUNDS, _FEW_ROUNDS = 6, 2
"""Rounds after which an order is good enough, and that of a large graph."""

_MOST_EDGES = 120  # edges of graphs in which neighbours change places by trial

_MOVABLE = ("system", "map:")
"""Views of which boxes may change places; services stand in the order of inheritance."""

_Cost = tuple[int, float]

_End = tuple[str, str]
"""The ids of a box and of its row."""

PartT = TypeVar("PartT")
_Part = tuple[str, bool]
"""The id of a box or frame, and whether it is a frame."""


def ordered(graph: Graph) -> Graph:
    """Returns a graph of the same boxes and rows, in an order in which few lines cross."""
    if not graph.view.startswith(_MOVABLE) or not graph.edges:
        return graph
    work = _Work(graph)
    work.improve()
    return replace(graph, nodes=tuple(work.nodes()))


class _Work:
    """One search.

    `siblings`: what stands in each frame, from above: boxes, and frames in it. `joined`: the other
    ends of the edges at an end. `arcs`: the ends of the edges within each column. `lanes`: those of
    the others by their left column, from the left.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._nodes = graph.by_id
        self._siblings: dict[str, list[_Part]] = defaultdict(list)
        for node in graph.nodes:
            self._siblings[node.group].append((node.id, False))
        for group in graph.groups:
            self._siblings[group.parent].append((group.id, True))
        # A frame stands where the first of its boxes is told.
        positions = {node.id: number for number, node in enumerate(graph.nodes)}
        for siblings in self._siblings.values():
            siblings.sort(
                key=lambda part: min((positions[name] for name in self._boxes(part)), default=0)
            )
        self._rows = {node.id: [port.id for port in node.ports] for node in graph.nodes}
        self._joined: dict[_End, list[_End]] = defaultdict(list)
        self._lanes: dict[int, list[tuple[_End, _End]]] = defaultdict(list)
        self._arcs: dict[int, list[tuple[_End, _End]]] = defaultdict(list)
        for edge in graph.edges:
            # A loop stays at its box, wherever that stands.
            if edge.source.node == edge.target.node:
                continue
            first, second = ((end.node, end.port) for end in (edge.source, edge.target))
            self._joined[first].append(second)
            self._joined[second].append(first)
            left, right = (self._nodes[name].column for name, _ in (first, second))
            lines = self._arcs if left == right else self._lanes
            lines[min(left, right)].append((first, second) if left <= right else (second, first))

    def nodes(self) -> Iterator[Node]:
        """Yields the boxes in their order, with their rows in theirs."""
        for name in self._boxes():
            ports = {port.id: port for port in self._nodes[name].ports}
            yield replace(self._nodes[name], ports=tuple(ports[row] for row in self._rows[name]))

    def improve(self) -> None:
        """Finds an order; the first of equally good ones stays."""
        best, least = self._order(), self._cost()
        is_large = sum(map(len, self._joined.values())) > 2 * _MOST_EDGES  # each has two ends
        for _ in range(_FEW_ROUNDS if is_large else _ROUNDS):
            self._sort_by_means()
            if (cost := self._cost()) < least:
                best, least = self._order(), cost
        self._siblings, self._rows = best
        if is_large:
            return
        for _ in range(_ROUNDS):
            before = least
            for siblings in self._siblings.values():
                least = self._swap(siblings, least)
            for rows in self._movable_rows().values():
                least = self._swap(rows, least)
            if least == before:
                return

    def _order(self) -> tuple[dict[str, list[_Part]], dict[str, list[str]]]:
        siblings = {frame: list(parts) for frame, parts in self._siblings.items()}
        return siblings, {box: list(rows) for box, rows in self._rows.items()}

    def _boxes(self, part: _Part = ("", True)) -> Iterator[str]:
        """Yields the boxes of a part: itself, or those in a frame, from above."""
        name, is_frame = part
        if not is_frame:
            yield name
            return
        for inner in self._siblings.get(name, ()):
            yield from self._boxes(inner)

    def _movable_rows(self) -> dict[str, list[str]]:
        """Returns the rows of each box that may change places."""
        return self._rows if self._graph.view == "system" else {}

    def _heights(self) -> dict[_End, float]:
        """Returns about how high the ends of edges stand: rows counted, columns centred."""
        counts: dict[int, int] = defaultdict(int)
        heights: dict[_End, float] = {}
        for name in self._boxes():
            column = self._nodes[name].column
            for row in ("", *self._rows[name]):
                heights[name, row] = counts[column]
                counts[column] += 1
            counts[column] += 1
        for name, row in heights:
            heights[name, row] -= counts[self._nodes[name].column] / 2
        return heights

    def _sort_by_means(self) -> None:
        """Moves parts, then rows, to the mean height of what they are joined with."""
        heights = self._heights()
        for siblings in self._siblings.values():
            means = {part: self._mean(self._ends(part), heights) for part in siblings}
            siblings.sort(key=means.__getitem__)
        heights = self._heights()
        for name, rows in self._movable_rows().items():
            of_rows = {row: self._mean([(name, row)], heights) for row in rows}
            rows.sort(key=of_rows.__getitem__)

    def _ends(self, part: _Part) -> list[_End]:
        return [(box, row) for box in self._boxes(part) for row in ("", *self._rows[box])]

    def _mean(self, ends: Sequence[_End], heights: Mapping[_End, float]) -> float:
        """Returns the mean height of what some ends are joined with, their own without any."""
        inside = {box for box, _ in ends}
        others = [
            heights[other]
            for own in ends
            for other in self._joined.get(own, ())
            if other[0] not in inside
        ]
        if not others:
            return sum(heights[end] for end in ends) / len(ends) if ends else 0
        return sum(others) / len(others)

    def _swap(self, parts: list[PartT], least: _Cost) -> _Cost:
        """Lets neighbours change places where that helps, and returns the cost then."""
        for one, other in pairwise(range(len(parts))):
            parts[one], parts[other] = parts[other], parts[one]
            cost = self._cost()
            if cost < least:
                least = cost
            else:
                parts[one], parts[other] = parts[other], parts[one]
        return least

    def _cost(self) -> _Cost:
        """Returns how many edges cross, and how far they lead up or down in all."""
        heights = self._heights()
        lanes, arcs = (
            {
                column: [(heights[first], heights[second]) for first, second in lines]
                for column, lines in columns.items()
            }
            for columns in (self._lanes, self._arcs)
        )
        crossed = sum(map(_inversions, lanes.values()))
        for column, lines in arcs.items():
            bent = [(min(ends), max(ends)) for ends in lines]
            crossed += sum(
                a < c < b < d or c < a < d < b for (a, b), (c, d) in combinations(bent, 2)
            )
            # Between two columns, an arc crosses what leaves from within it; those of column 0
            # bend to the left, where no lines leave.
            leaving = lanes.get(column, ()) if column else ()
            crossed += sum(a < at < b for a, b in bent for at, _ in leaving)
        lengths = (abs(a - b) for lines in (*lanes.values(), *arcs.values()) for a, b in lines)
        return crossed, round(sum(lengths), 3)


def _inversions(lines: Sequence[tuple[float, float]]) -> int:
    """Returns how many pairs of lines from one column cross, as if all led to the next one."""
    seen: list[float] = []
    crossed = 0
    for _, right in sorted(lines):
        crossed += len(seen) - bisect_right(seen, right)
        insort(seen, right)
    return crossed
