"""Building of graphs: boxes whose rows are found one by one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.views.diagrams.graph import Edge, End, Graph, Group, Node, Port

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.views.diagrams.views.context import Context


class Builder:
    """A graph that grows."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.boxes: dict[str, Node] = {}
        self.groups: list[Group] = []
        self.edges: list[Edge] = []
        self.endpoints: list[tuple[str, str, End]] = []
        self._ports: dict[str, dict[str, Port]] = {}

    def add(self, node: Node) -> str:
        """Adds a box unless there is one of its id, and returns the id."""
        if node.id not in self.boxes:
            self.boxes[node.id] = node
            self._ports[node.id] = {each.id: each for each in node.ports}
        return node.id

    def put(self, node: str, port: Port) -> End:
        """Adds a row to a box unless it has one of its id, and returns the end there."""
        self._ports[node].setdefault(port.id, port)
        return End(node, port.id)

    def has(self, end: End) -> bool:
        """Tells whether there is such an end."""
        return end.port in self._ports.get(end.node, {})

    def graph(
        self, title: str, element: EObject | None = None, *, downwards: bool = False
    ) -> Graph:
        """Returns the graph, without frames around nothing.

        Args:
            element: The element that it shows; None for the whole model.
        """
        named = self.context.named
        nodes = tuple(
            replace(named(node), ports=tuple(named(port) for port in self._ports[node.id].values()))
            for node in self.boxes.values()
        )
        used = {node.group for node in nodes}
        for each in reversed(self.groups):
            if each.id in used:
                used.add(each.parent)
        return Graph(
            self.context.view,
            title,
            nodes,
            tuple(named(each) for each in self.groups if each.id in used),
            tuple(named(each) for each in _distinct(self.edges)),
            downwards,
            self.context.of_files(),
            self.context.reference(element),
        )


def _distinct(edges: list[Edge]) -> list[Edge]:
    """Returns edges with ids of their own: later ones that share one are numbered."""
    counts: dict[str, int] = {}
    found = []
    for each in edges:
        counts[each.id] = counts.get(each.id, 0) + 1
        number = counts[each.id]
        found.append(each if number == 1 else replace(each, id=f"{each.id}!{number}"))
    return found
