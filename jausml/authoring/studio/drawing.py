"""Drawings: views as pages draw them, and what has changed from one picture to the next."""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jausml.authoring.studio.memory import Memory
from jausml.views.diagrams.bundling import framed, is_crowded
from jausml.views.diagrams.folding import is_large
from jausml.views.diagrams.graph import Graph, Node
from jausml.views.diagrams.layout.sheet import LayoutError, Point
from jausml.views.diagrams.writers import values

_LOG = logging.getLogger(__name__)

_MOST_PICTURES = 8  # pictures of a view that are remembered: as many pages get differences

_INTO = 60  # pixels from the corner of a box to where one looks at it

_LISTS = ("nodes", "groups", "edges")


@dataclass
class _View:
    """The state of a view; the lock is held while it is drawn.

    `expected`: where the boxes of new elements were dropped, by element.
    """

    standing: values.Standing
    lock: threading.Lock = field(default_factory=threading.Lock)
    expected: dict[str, Point] = field(default_factory=dict)
    settled: values.Settled | None = None
    of: object = None
    pictures: OrderedDict[int, dict[str, Any]] = field(default_factory=OrderedDict)
    count: int = 0

    def seen(self, opened: Collection[str]) -> Collection[str] | None:
        """Returns which frames are opened, None where all are."""
        return opened if self.standing.is_large else None


class Drawings:
    """Views as pages draw them: boxes stay in place until a user arranges them."""

    def __init__(self, root: Path) -> None:
        """Begins with the remembered places in the views of files below a folder."""
        self._lock = threading.Lock()
        self._memory = Memory(root)
        self._views: dict[tuple[str, str], _View] = {}
        self._names: dict[str, list[str]] = {}

    def follow(self, file: str, names: list[str]) -> None:
        """Keeps what is known of views whose names have changed, where all others are there."""
        with self._lock:
            before = self._names.get(file, [])
            self._names[file] = names
            renamed = zip(before, names, strict=False) if len(before) == len(names) else ()
            for old, new in renamed:
                if old not in names and new not in before and (file, old) in self._views:
                    self._views[file, new] = self._views.pop((file, old))

    def draw(
        self,
        file: str,
        graph: Graph,
        moved: Mapping[str, tuple[int, int]],
        opened: Collection[str] = (),
        of: object = None,
    ) -> dict[str, Any]:
        """Returns a graph with sizes and places.

        `opened`: keys of the frames of a large system that are shown with what is in them. `of`:
        what the graph was made of; see `again`.
        """
        view = self._view(file, graph.view)
        with view.lock:
            last, view.settled = view.settled, None
            try:
                settled = self._settled(view, graph, moved, last)
            except LayoutError:
                raise
            except Exception:
                # What is remembered of former pictures must not keep the view from being shown.
                _LOG.exception("the view %s of %s is drawn anew", graph.view, file)
                view.standing = values.Standing()
                settled = self._settled(view, graph, moved, None)
            view.settled, view.of = settled, of
            self._memory.keep(file, {graph.view: view.standing})
            return settled.values(view.seen(opened))

    def again(
        self, file: str, name: str, opened: Collection[str], of: object
    ) -> dict[str, Any] | None:
        """Returns the last picture with other frames opened.

        None where a graph of something else was drawn last, or nothing.
        """
        view = self._view(file, name)
        with view.lock:
            if view.settled is None or view.of is None or view.of != of:
                return None
            return view.settled.values(view.seen(opened))

    def _settled(
        self,
        view: _View,
        graph: Graph,
        moved: Mapping[str, tuple[int, int]],
        last: values.Settled | None,
    ) -> values.Settled:
        standing = view.standing
        if not standing.shown:
            standing.is_crowded = is_crowded(graph)
        shown = framed(graph) if standing.is_crowded else graph
        if not standing.shown:
            standing.is_large = is_large(shown)
        for node in shown.nodes:
            if node.element in view.expected:
                standing.boxes[node.key or node.id] = view.expected.pop(node.element)
        return values.settled(shown, moved, standing, last=last.places if last else None)

    def expect(self, file: str, name: str, element: str, corner: Point) -> None:
        """Lets the box of a new element stand where it was dropped."""
        view = self._view(file, name)
        with view.lock:
            view.expected = {element: corner}

    def number(self, file: str, picture: dict[str, Any]) -> int:
        """Remembers a picture that a page is sent, and returns its number."""
        view = self._view(file, picture["view"])
        with view.lock:
            view.count += 1
            view.pictures[view.count] = picture
            while len(view.pictures) > _MOST_PICTURES:
                view.pictures.popitem(last=False)
            return view.count

    def numbered(self, file: str, name: str, number: int) -> dict[str, Any] | None:
        """Returns a picture that a page was sent, None when it is remembered no more."""
        view = self._view(file, name)
        with view.lock:
            return view.pictures.get(number)

    def where(self, file: str, name: str, element: str) -> Point | None:
        """Returns a point in the box of an element, None where the view has none."""
        view = self._view(file, name)
        with view.lock:
            if view.settled is None:
                return None
            node = _box_of(view.settled.graph, element)
            if node is None:
                return None
            left, top = view.settled.places.corners[node.id]
            return left + _INTO, top + _INTO

    def forget(self, file: str, name: str) -> None:
        """Forgets where the boxes of a view stand."""
        view = self._view(file, name)
        with view.lock:
            view.standing = values.Standing()
            view.settled = None

    def _view(self, file: str, name: str) -> _View:
        with self._lock:
            if (file, name) not in self._views:
                self._views[file, name] = _View(self._memory.standing(file, name))
            return self._views[file, name]


def _box_of(graph: Graph, element: str) -> Node | None:
    nodes = graph.by_id
    for node in graph.nodes:
        if element in (node.element, *(port.element for port in node.ports)):
            return node
    groups = {group.id for group in graph.groups if group.element == element}
    inside = [inner_node for inner_node in graph.nodes if inner_node.group in groups]
    lines = [nodes[edge.source.node] for edge in graph.edges if edge.element == element]
    return next(iter(inside + lines), None)


def difference(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the difference of two pictures: parts that are new or gone, by id.

    Parts that are put take the place of those of their id, or come behind the others; where that
    is not their order, it is told.
    """
    changed: dict[str, Any] = {
        "rest": {name: value for name, value in after.items() if name not in _LISTS}
    }
    for name in _LISTS:
        old = {part["id"]: part for part in before[name]}
        new = {part["id"]: part for part in after[name]}
        order = [
            *(part_id for part_id in old if part_id in new),
            *(part_id for part_id in new if part_id not in old),
        ]
        changed[name] = {
            "put": [part for key, part in new.items() if old.get(key) != part],
            "gone": [part_id for part_id in old if part_id not in new],
            "order": None if order == list(new) else list(new),
        }
    return changed
