"""Heights of boxes that keep their order: what is joined stands level where there is room.

Each box, with those that it would push away, goes to where most of its lines are level.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median_low
from typing import NamedTuple

from jausml.views.diagrams.layout.settling import GAP

_ROUNDS = 24
_LEAST = 0.5  # pixels that are worth a step


class Link(NamedTuple):
    """A line between two boxes, by how far below their tops it ends; level if `is_arc` is not."""

    one: str
    other: str
    one_down: float
    other_down: float
    is_arc: bool


@dataclass(frozen=True)
class Item:
    """A box that is moved, or a frame with its contents.

    Attributes:
        tops: How far below its top its boxes stand, by id.
        columns: The first and last column that it takes.
    """

    tops: Mapping[str, float]
    height: float
    columns: tuple[int, int]

    def framed(self, margin: float, title: float) -> Item:
        """Returns the item in a frame, with a margin and the height of a title."""
        tops = {name: top + margin + title for name, top in self.tops.items()}
        return Item(tops, self.height + title + 2 * margin, self.columns)


def levelled(items: Sequence[Item], links: Sequence[Link]) -> Item:
    """Returns items as one, each below those before it in its columns."""
    work = _Work(items, links)
    work.level()
    least = min(work.tops, default=0)
    tops = {
        name: round(top - least + down)
        for item, top in zip(items, work.tops, strict=True)
        for name, down in item.tops.items()
    }
    height = max(
        (top - least + item.height for item, top in zip(items, work.tops, strict=True)), default=0
    )
    spans = [item.columns for item in items] or [(0, 0)]
    columns = min(first for first, _ in spans), max(last for _, last in spans)
    return Item(tops, round(height), columns)


class _Work:
    def __init__(self, items: Sequence[Item], links: Sequence[Link]) -> None:
        self._items = items
        self._below: dict[int, list[int]] = defaultdict(list)
        self._above: dict[int, list[int]] = defaultdict(list)
        self._links: dict[int, list[tuple[int, float]]] = defaultdict(list)
        self._stack()
        owner = {name: number for number, item in enumerate(items) for name in item.tops}
        for link in links:
            one, other = owner.get(link.one), owner.get(link.other)
            if one is None or other is None or one == other or link.is_arc:
                continue
            down = items[other].tops[link.other] + link.other_down
            down -= items[one].tops[link.one] + link.one_down
            self._links[one].append((other, down))
            self._links[other].append((one, -down))

    def _stack(self) -> None:
        """Puts each item right below the lowest of those before it in its columns."""
        last: dict[int, int] = {}
        self.tops: list[float] = []
        for number, item in enumerate(self._items):
            span = range(item.columns[0], item.columns[1] + 1)
            before = {last[column] for column in span if column in last}
            self.tops.append(max((self._bottom(other) for other in before), default=0))
            for other in before:
                self._below[other].append(number)
                self._above[number].append(other)
            last.update(dict.fromkeys(span, number))

    def _bottom(self, number: int) -> float:
        return self.tops[number] + self._items[number].height + GAP

    def level(self) -> None:
        """Moves items until no step helps."""
        joined = list(self._links)
        for _ in range(_ROUNDS):
            steps = [self._push(number, way) for number in joined for way in (1, -1)]
            if not any(steps):
                return

    def _push(self, number: int, way: int) -> bool:
        """Moves an item down (1) or up (-1), with its neighbours, if that helps."""
        pushed = self._touched(number, way)
        wished = [
            way * (self.tops[other] + down - self.tops[item])
            for item in pushed
            for other, down in self._links[item]
            if other not in pushed
        ]
        wish = median_low(wished) if wished else 0
        room = [space for _, space in self._spaces(pushed, way)]
        step = min(wish, *room) if room else wish
        if step < _LEAST:
            return False
        for item in pushed:
            self.tops[item] += way * step
        return True

    def _touched(self, number: int, way: int) -> set[int]:
        pushed = {number}
        while near := {other for other, space in self._spaces(pushed, way) if space < _LEAST}:
            pushed |= near
        return pushed

    def _spaces(self, pushed: Collection[int], way: int) -> Iterator[tuple[int, float]]:
        """Yields the neighbours of some items on one side, and the space between."""
        for item in pushed:
            for other in (self._below if way > 0 else self._above)[item]:
                if other not in pushed:
                    upper, lower = (item, other) if way > 0 else (other, item)
                    yield other, self.tops[lower] - self._bottom(upper)
