"""Drawing: where the boxes of each view stand, as long as the session lasts."""

from __future__ import annotations

import logging
import threading
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jausml.views.diagrams.bundling import framed, is_crowded
from jausml.views.diagrams.layout.columns import Columns
from jausml.views.diagrams.layout.graphviz import Graphviz
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.writers import values

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.views.diagrams.graph import Graph

_LOG = logging.getLogger(__name__)


@dataclass
class _View:
    """What is known of a view; the lock is held while it is drawn.

    Whether it is crowded is decided when its boxes get their places: no edit moves them.
    """

    lock: threading.Lock = field(default_factory=threading.Lock)
    standing: values.Standing = field(default_factory=values.Standing)
    is_crowded: bool = False


class Drawings:
    """Views as pages draw them: what stands stays until someone asks to arrange it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._views: dict[tuple[str, str], _View] = defaultdict(_View)
        self._engine = Graphviz()

    def draw(self, file: str, graph: Graph, moved: Mapping[str, tuple[int, int]]) -> dict[str, Any]:
        """Returns a graph with sizes and places."""
        view = self._view(file, graph.view)
        with view.lock:
            try:
                return self._drawn(view, graph, moved)
            except LayoutError:
                raise
            except Exception:
                # What is remembered of former pictures must not keep the view from being shown.
                _LOG.exception("the view %s of %s is drawn anew", graph.view, file)
                view.standing = values.Standing()
                return self._drawn(view, graph, moved)

    def _drawn(
        self, view: _View, graph: Graph, moved: Mapping[str, tuple[int, int]]
    ) -> dict[str, Any]:
        if not view.standing.shown:
            view.is_crowded = is_crowded(graph)
        if view.is_crowded:
            return values.render(framed(graph), Columns(), moved, view.standing)
        return values.render(graph, self._engine, moved, view.standing)

    def forget(self, file: str, name: str) -> None:
        """Forgets where the boxes of a view stand."""
        view = self._view(file, name)
        with view.lock:
            view.standing = values.Standing()

    def _view(self, file: str, name: str) -> _View:
        with self._lock:
            return self._views[file, name]
