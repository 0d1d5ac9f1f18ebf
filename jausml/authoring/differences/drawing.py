"""Diagrams of what changed: the graph of the new state, with what the old one had besides.

Each part that came, went or changed has a state for its colour, and a sign before its text: who
sees no colours sees the same.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from jausml.authoring.differences.changes import Change, Kind
from jausml.authoring.differences.matching import Matching
from jausml.language.model import refs
from jausml.language.model.model import Model
from jausml.language.model.names import with_owners
from jausml.language.model.refs import Ref
from jausml.views.diagrams.graph import ADDED, CHANGED, REMOVED, Edge, End, Graph, Group, Node, Port

PartT = TypeVar("PartT", Node, Port, Group)

_SIGNS = {ADDED: "+", REMOVED: "\N{MINUS SIGN}", CHANGED: "~"}
_OLD = "old!"  # before the ids of parts that the new state has no more


@dataclass(frozen=True)
class Drawn:
    """A state and its graph."""

    graph: Graph
    model: Model
    root: Path


def compared(old: Drawn, new: Drawn, matching: Matching, changes: Sequence[Change]) -> Graph:
    """Returns the graph of the new state with what was added, removed and changed."""
    same: dict[Ref, Ref] = {}
    for before, after in matching.news.items():
        same[refs.ref_of(before, old.model, old.root)] = refs.ref_of(after, new.model, new.root)
    return _Comparison(old.graph, new.graph, same, _texts(old, new, same, changes)).graph()


def _texts(
    old: Drawn, new: Drawn, same: Mapping[Ref, Ref], changes: Iterable[Change]
) -> dict[Ref, list[str]]:
    """Returns the words of the changes, by the references of the parts of the new state."""
    shown = {part.element for part in _parts(new.graph) if part.element}
    texts: dict[Ref, list[str]] = defaultdict(list)
    for change in changes:
        obj, side = change.new_element, new
        if change.kind is Kind.REMOVED:
            obj, side = change.old_element, old
        text = f"{change.element} {change.path}: {change.text}"
        for element in with_owners(obj):
            ref = refs.ref_of(element, side.model, side.root)
            ref = ref if side is new else same.get(ref, "")
            if ref in shown:
                texts[ref].append(text)
                break
    return texts


def _parts(graph: Graph) -> Iterable[Node | Port | Group | Edge]:
    yield from graph.groups
    yield from graph.edges
    for node in graph.nodes:
        yield node
        yield from node.ports


class _Comparison:
    """Works out the union of two graphs, from frames inwards to rows, and then the lines."""

    def __init__(
        self, old: Graph, new: Graph, same: Mapping[Ref, Ref], texts: Mapping[Ref, Sequence[str]]
    ) -> None:
        self._old, self._new = old, new
        self._same, self._texts = same, texts
        self._groups: dict[str, str] = {"": ""}
        self._ends: dict[End, End] = {}

    def graph(self) -> Graph:
        groups = self._united_groups()
        nodes = self._united_nodes()
        edges = self._united_edges()
        return replace(
            self._new,
            title=f"{self._new.title or self._old.title}: what changed",
            downwards=self._new.downwards or self._old.downwards,
            groups=tuple(groups),
            nodes=tuple(nodes),
            edges=tuple(edges),
        )

    def _pairs(self, old: Sequence[PartT], new: Sequence[PartT]) -> dict[str, PartT]:
        """Returns the new parts by the ids of the old ones that are the same."""
        by_element: dict[tuple[str, Ref], list[PartT]] = defaultdict(list)
        by_key: dict[str, PartT] = {}
        for node in new:
            if node.element:
                by_element[getattr(node, "kind", ""), node.element].append(node)
            else:
                by_key[node.key or node.id] = node
        pairs: dict[str, PartT] = {}
        for part in old:
            if part.element:
                ref = self._same.get(part.element, part.element)
                waiting = by_element.get((getattr(part, "kind", ""), ref))
                if waiting:
                    pairs[part.id] = waiting.pop(0)
            elif (part.key or part.id) in by_key:
                pairs[part.id] = by_key.pop(part.key or part.id)
        return pairs

    def _state(self, part: PartT | Edge, known: set[str]) -> str:
        if part.id not in known:
            return ADDED
        return CHANGED if part.element in self._texts else ""

    def _united_groups(self) -> list[Group]:
        pairs = self._pairs(self._old.groups, self._new.groups)
        known = {pair.id for pair in pairs.values()}
        groups = [_signed_group(group, self._state(group, known)) for group in self._new.groups]
        for group in self._old.groups:
            new = pairs.get(group.id)
            self._groups[group.id] = new.id if new is not None else f"{_OLD}{group.id}"
            if new is None:
                parent = self._groups[group.parent]
                gone = replace(group, id=f"{_OLD}{group.id}", parent=parent)
                groups.append(_signed_group(gone, REMOVED))
        return groups

    def _united_nodes(self) -> list[Node]:
        pairs = self._pairs(self._old.nodes, self._new.nodes)
        olds = {new.id: self._old.by_id[old] for old, new in pairs.items()}
        nodes = [self._node(olds.get(node.id), node, set(olds)) for node in self._new.nodes]
        for node in self._old.nodes:
            if node.id not in pairs:
                gone = replace(node, id=f"{_OLD}{node.id}", group=self._groups[node.group])
                for port in ("", *(port.id for port in node.ports)):
                    self._ends[End(node.id, port)] = End(gone.id, port)
                nodes.append(_signed_node(gone, REMOVED, ()))
        return nodes

    def _node(self, old: Node | None, new: Node, known: set[str]) -> Node:
        state = self._state(new, known)
        if old is None:
            return _signed_node(new, state, ())
        pairs = self._pairs(old.ports, new.ports)
        staying = {pair.id for pair in pairs.values()}
        rows = [self._row(port, self._state(port, staying)) for port in new.ports]
        self._ends[End(old.id)] = End(new.id)
        at = 0
        for port in old.ports:
            same = pairs.get(port.id)
            if same is None:
                gone = replace(port, id=f"{_OLD}{port.id}")
                rows.insert(at, self._row(gone, REMOVED))
            identity = f"{_OLD}{port.id}" if same is None else same.id
            self._ends[End(old.id, port.id)] = End(new.id, identity)
            at = next(index for index, row in enumerate(rows) if row.id == identity) + 1
        return _signed_node(replace(new, ports=tuple(rows)), state, self._details(new))

    def _row(self, port: Port, state: str) -> Port:
        if not state:
            return port
        label = f"{_SIGNS[state]} {port.label}"
        details = (*port.details, *self._details(port))
        return replace(port, label=label, state=state, details=details)

    def _details(self, part: Node | Port | Edge) -> tuple[tuple[str, str], ...]:
        return tuple(("what changed", text) for text in self._texts.get(part.element, ()))

    def _united_edges(self) -> list[Edge]:
        left: dict[tuple[object, ...], list[Edge]] = defaultdict(list)
        for edge in self._old.edges:
            moved = replace(
                edge,
                id=f"{_OLD}{edge.id}",
                source=self._ends[edge.source],
                target=self._ends[edge.target],
            )
            element = self._same.get(edge.element, edge.element)
            left[_signature(moved, element)].append(moved)
        edges = []
        for edge in self._new.edges:
            waiting = left.get(_signature(edge, edge.element))
            if waiting:
                waiting.pop(0)
            state = self._state(edge, {edge.id} if waiting is not None else set())
            edges.append(_signed_edge(edge, state, self._details(edge)))
            if waiting == []:
                del left[_signature(edge, edge.element)]
        gone = (edge for rest in left.values() for edge in rest)
        return [*edges, *(_signed_edge(edge, REMOVED, ()) for edge in gone)]


def _signature(edge: Edge, element: Ref) -> tuple[object, ...]:
    """Returns the key under which an edge of one state and that of the other are the same."""
    return edge.kind, edge.source, edge.target, element or edge.title


def _signed_group(group: Group, state: str) -> Group:
    title = f"{_SIGNS[state]} {group.title}" if state else group.title
    return replace(group, title=title, state=state)


def _signed_node(node: Node, state: str, details: tuple[tuple[str, str], ...]) -> Node:
    title = f"{_SIGNS[state]} {node.title}" if state else node.title
    return replace(node, title=title, state=state, details=(*node.details, *details))


def _signed_edge(edge: Edge, state: str, details: tuple[tuple[str, str], ...]) -> Edge:
    if not state:
        return edge
    sign = _SIGNS[state]
    first, *others = edge.labels or ("",)
    labels = (f"{sign} {first}".rstrip(), *others)
    title = f"{sign} {edge.title}".rstrip()
    details = (*edge.details, *details)
    return replace(edge, title=title, labels=labels, state=state, details=details)
