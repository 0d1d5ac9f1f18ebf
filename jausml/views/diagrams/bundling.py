"""Crowded systems: a frame for each bridge, and one edge for all between the same two boxes."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import replace

from jausml.views.diagrams.graph import CHANGED, Edge, End, Graph, Group, Node, Port

MOST_EDGES = 80
"""Edges that a drawing shows one by one without frames of its own."""

FRAME = "!frame"
"""Behind the id of a bridge: its frame."""


def bundled(graph: Graph) -> Graph:
    """Returns a readable graph: as it is, or bundled where it has too many edges.

    What two frames have in common is told in the boxes, not by edges across.
    """
    bridges = [node for node in graph.nodes if node.kind == "bridge"]
    if not is_crowded(graph):
        return graph
    frames = bridges_around(graph)
    inside: dict[tuple[str, str, str], list[Edge]] = defaultdict(list)
    within: dict[str, Counter[str]] = defaultdict(Counter)
    across: dict[str, Counter[str]] = defaultdict(Counter)
    for edge in graph.edges:
        source, target = edge.source.node, edge.target.node
        is_inside = bool(frames[source]) and frames[source] == frames[target]
        if is_inside:
            inside[source, target, edge.kind].append(edge)
        # A loop is one line of its box.
        for one, other in {(source, target), (target, source)}:
            (within if is_inside else across)[one][other] += 1
    nodes = graph.by_id
    hosts = {group.id: group.title for group in graph.groups}
    return replace(
        graph,
        nodes=tuple(
            _box(node, frames[node.id], within[node.id], across[node.id], nodes, hosts)
            for node in graph.nodes
        ),
        groups=tuple(map(_frame_of, bridges)),
        edges=tuple(_bundle(edge_group, {b.id for b in bridges}) for edge_group in inside.values()),
    )


def _frame_of(bridge: Node) -> Group:
    own, key = f"{bridge.id}{FRAME}", f"{bridge.key}{FRAME}"
    return Group(own, "bridge", bridge.title, element=bridge.element, key=key)


def _box(
    node: Node,
    frame: str,
    within: Counter[str],
    across: Counter[str],
    nodes: dict[str, Node],
    hosts: dict[str, str],
) -> Node:
    shown = {} if node.kind == "bridge" else within
    rows = tuple(
        Port(
            f"{node.id}!{way} {other}",
            f"{words} {nodes[other].title}",
            _words(count),
            key=f"{node.key}!{way} {nodes[other].key}",
        )
        for way, words, counts in (("with", "with", shown), ("also", "also with", across))
        for other, count in counts.items()
    )
    host = hosts.get(node.group, "")
    subtitle = f"{node.subtitle}, {host}" if host else node.subtitle
    findings = dict.fromkeys(
        [*node.findings, *(finding for port in node.ports for finding in port.findings)]
    )
    return replace(
        node,
        ports=rows,
        group=f"{frame}{FRAME}" if frame else "",
        subtitle=subtitle,
        details=(*node.details, *((port.label, port.note) for port in node.ports)),
        findings=tuple(findings),
        state=node.state or (CHANGED if any(port.state for port in node.ports) else ""),
    )


def _bundle(edges: list[Edge], bridges: set[str]) -> Edge:
    first = edges[0]
    titles = dict.fromkeys(edge.title for edge in edges)
    return replace(
        first,
        source=_end(first.source.node, first.target.node, bridges),
        target=_end(first.target.node, first.source.node, bridges),
        title=", ".join(titles),
        labels=(),
        count=len(edges),
        element=first.element if len(edges) == 1 else "",
        details=tuple((edge.title, ", ".join(edge.labels) or edge.kind) for edge in edges),
        findings=tuple(dict.fromkeys(finding for edge in edges for finding in edge.findings)),
        state=_common_state(edges),
    )


def _common_state(edges: list[Edge]) -> str:
    states = {edge.state for edge in edges}
    return states.pop() if len(states) == 1 else CHANGED


def _end(node: str, other: str, bridges: set[str]) -> End:
    """Returns the end of a bundle: the row of a box that tells how much there is."""
    return End(node) if node in bridges else End(node, f"{node}!with {other}")


def _words(count: int) -> str:
    return f"{count} connection{'s' if count > 1 else ''}"


def is_crowded(graph: Graph) -> bool:
    """Tells whether a graph has too many edges to be read without frames around its bridges."""
    return len(graph.edges) > MOST_EDGES and any(node.kind == "bridge" for node in graph.nodes)


def framed(graph: Graph) -> Graph:
    """Returns a graph with a frame around each bridge and its closest partners.

    It is for a page that is edited, where what is not shown could not be changed.

    What runs on another host than the bridge stays in the frame of its host. Nodes that are not
    modelled run on no host that is known.
    """
    homes = bridges_around(graph)
    nodes = graph.by_id
    bridges = [node for node in graph.nodes if node.kind == "bridge"]
    return replace(
        graph,
        nodes=tuple(
            replace(node, group=f"{home}{FRAME}")
            if (home := homes[node.id])
            and (node.kind == "others" or node.group == nodes[home].group)
            else node
            for node in graph.nodes
        ),
        groups=(
            *graph.groups,
            *(replace(_frame_of(bridge), parent=bridge.group) for bridge in bridges),
        ),
        is_crowded=True,
    )


def bridges_around(graph: Graph) -> dict[str, str]:
    """Returns by node the bridge that it exchanges most with; empty for none."""
    bridges = {node.id for node in graph.nodes if node.kind == "bridge"}
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for edge in graph.edges:
        for one, other in (
            (edge.source.node, edge.target.node),
            (edge.target.node, edge.source.node),
        ):
            if other in bridges:
                counts[one][other] += 1
    return {
        node.id: node.id
        if node.id in bridges
        else next((bridge for bridge, _ in counts[node.id].most_common(1)), "")
        for node in graph.nodes
    }
