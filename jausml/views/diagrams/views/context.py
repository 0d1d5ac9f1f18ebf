"""The context of all views: ids, findings and texts of elements, and a graph that is built up."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Diagnostic
from jausml.language.model.model import Model
from jausml.language.model.refs import Keys, file_mark, ref_of
from jausml.views.diagrams.graph import Details, Edge, End, Finding, Graph, Group, Node, Port

PartT = TypeVar("PartT", Node, Port, Group, Edge)


class Context:
    """A model as views see it.

    `root`: the folder to which references are relative; None for that of the first file.
    """

    def __init__(
        self, model: Model, view: str, diagnostics: Iterable[Diagnostic], root: Path | None = None
    ) -> None:
        self.model = model
        self.view = view
        self._root = Path(os.path.realpath(root)) if root else model.documents[0].path.parent
        self._elements: dict[str, EObject] = {}
        self._ids: dict[EObject, str] = {}
        self._keys: dict[EObject, str] = {}
        self._findings: dict[tuple[str, str], list[Finding]] = defaultdict(list)
        for diagnostic in sorted(diagnostics):
            finding = Finding(diagnostic.severity.value, diagnostic.rule, diagnostic.message)
            key = (
                (diagnostic.location.path, diagnostic.fragment) if diagnostic.fragment else ("", "")
            )
            self._findings[key].append(finding)

    def id_of(self, element: EObject) -> str:
        """Returns the id of an element: its fragment, behind its file unless that is the first."""
        known = self._ids.get(element)
        if known is not None:
            return known
        mark = file_mark(self.model.document_of(element), self.model)
        identifier = f"{mark}{self.model.fragment(element)}"
        self._elements[identifier] = element
        self._ids[element] = identifier
        return identifier

    def reference(self, element: EObject | None) -> str:
        """Returns the reference to an element, empty for none."""
        return ref_of(element, self.model, self._root)

    def named(self, part: PartT, **more: Any) -> PartT:
        """Returns a part with its key, and with the element of its id if there is one.

        `more`: what else of it is another.
        """
        element = part.element or self.reference(self._elements.get(part.id))
        return replace(part, element=element, key=part.key or self._key_of(part.id), **more)

    def _key_of(self, identifier: str) -> str:
        if identifier in self._elements:
            return self.key(self._elements[identifier])
        known = ((word, self._elements.get(word)) for word in identifier.split("!"))
        return "!".join(word if element is None else self.key(element) for word, element in known)

    def key(self, element: EObject) -> str:
        """Returns the name of an element that outlasts new positions of elements."""
        if element not in self._keys:
            self._keys[element] = self.model.derived(Keys).of(element)
        return self._keys[element]

    def findings(self, *elements: EObject | None, deep: bool = True) -> tuple[Finding, ...]:
        """Returns the findings about elements.

        `elements`: the elements; None is passed over.
        """
        if not self._findings:
            return ()
        findings: dict[Finding, None] = {}
        pending = [subject for subject in reversed(elements) if subject is not None]
        while pending:
            element = pending.pop()
            document = self.model.document_of(element)
            path = document.display if document is not None else ""
            for finding in self._findings.get((path, self.model.fragment(element)), ()):
                findings[finding] = None
            if deep:
                pending += reversed(self.model.owned(element))
        return tuple(findings)

    def row(
        self, element: EObject, label: str, note: str = "", mark: str = "", /, **more: object
    ) -> Port:
        """Returns the row of an element, with its details for requests: more, by names."""
        return Port(
            self.id_of(element),
            label,
            note,
            mark,
            details=details(element, **more),
            findings=self.findings(element),
            element=self.reference(element),
        )

    def of_files(self) -> tuple[Finding, ...]:
        """Returns the findings about files that are not about an element."""
        return tuple(dict.fromkeys(self._findings.get(("", ""), ())))


def details(element: EObject, **more: object) -> Details:
    """Returns the details of an element: its documentation, then more.

    `more`: names and values; empty values are left out.
    """
    texts = {"documentation": getattr(element, "documentation", None), **more}
    return tuple((name, str(value)) for name, value in texts.items() if value not in (None, ""))


def name_of(element: EObject | None) -> str:
    """Returns the name of an element, or what stands for a name that is not there."""
    return str(getattr(element, "name", None) or "?")


def number(value: float) -> str:
    """Returns a number with no more digits than it needs."""
    return f"{value:.10g}"


class Builder:
    """A graph that grows.

    `carried`: what connections carry from or to boxes, messages and services, by ids of boxes.
    """

    def __init__(self, context: Context) -> None:
        self.context = context
        self.boxes: dict[str, Node] = {}
        self.groups: list[Group] = []
        self.edges: list[Edge] = []
        self.endpoints: list[tuple[str, str, End]] = []
        self.carried: dict[str, list[EObject]] = {}
        self._ports: dict[str, dict[str, Port]] = {}

    def add(self, node: Node) -> str:
        """Adds a box unless there is one of its id, and returns the id."""
        if node.id not in self.boxes:
            self.boxes[node.id] = node
            self._ports[node.id] = {port.id: port for port in node.ports}
        return node.id

    def put(self, node: str, port: Port) -> End:
        """Adds a row to a box unless it has one of its id, and returns the end there."""
        self._ports[node].setdefault(port.id, port)
        return End(node, port.id)

    def carry(self, node: str, what: EObject | None) -> None:
        """Notes what a connection carries from or to a box."""
        if what is not None:
            self.carried.setdefault(node, []).append(what)

    def has(self, end: End) -> bool:
        """Tells whether there is such an end."""
        return end.port in self._ports.get(end.node, {})

    def graph(
        self, title: str, element: EObject | None = None, *, downwards: bool = False
    ) -> Graph:
        """Returns the graph, without frames around nothing.

        `element`: the element that it shows; None for the whole model.
        """
        named = self.context.named
        nodes = tuple(
            named(node, ports=tuple(map(named, self._ports[node.id].values())))
            for node in self.boxes.values()
        )
        used = {node.group for node in nodes}
        for group in reversed(self.groups):
            if group.id in used:
                used.add(group.parent)
        return Graph(
            self.context.view,
            title,
            nodes,
            tuple(named(group) for group in self.groups if group.id in used),
            tuple(named(edge) for edge in _distinct(self.edges)),
            downwards,
            self.context.of_files(),
            self.context.reference(element),
        )


def _distinct(edges: list[Edge]) -> list[Edge]:
    """Returns edges with ids of their own: later ones that share one are numbered."""
    counts: dict[str, int] = {}
    numbered_edges = []
    for edge in edges:
        counts[edge.id] = counts.get(edge.id, 0) + 1
        number = counts[edge.id]
        numbered_edges.append(edge if number == 1 else replace(edge, id=f"{edge.id}!{number}"))
    return numbered_edges
