"""Large pictures: frames that are closed stand as boxes that tell how much is in them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace

from jausml.views.diagrams.graph import Edge, End, Finding, Graph, Group, Node, severity

MOST_SHOWN = 150
"""Boxes that are shown without closed frames."""

CLOSED = "closed"
"""Kind of the box that stands for a closed frame."""

_WORDS = {
    "host": ("host", "hosts"),
    "bridge": ("bridge", "bridges"),
    "component": ("component", "components"),
    "node": ("node", "nodes"),
    "others": ("group of other nodes", "groups of other nodes"),
}
_OTHERS = ("box", "boxes")
_LINES = ("line", "lines")


def is_large(graph: Graph) -> bool:
    """Tells whether a graph is so large that its frames are closed at first."""
    return len(graph.nodes) > MOST_SHOWN and bool(graph.groups)


def folded(graph: Graph, opened: Collection[str]) -> Graph:
    """Returns a graph in which all but some frames are closed.

    A line into a closed frame ends at the frame, and those between the same two ends are one.
    `opened`: keys of frames; one that stands in a closed frame is not seen.
    """
    homes = _homes(graph, opened)
    insides = _insides(graph, homes)
    groups = {group.id: group for group in graph.groups}
    return replace(
        graph,
        nodes=(
            *(node for node in graph.nodes if not homes[node.id]),
            *(_closed(groups[name], inside) for name, inside in insides.items()),
        ),
        groups=tuple(
            group
            for group in graph.groups
            if group.key in opened and not _closed_around(group.parent, groups, opened)
        ),
        edges=tuple(_edges(graph, homes)),
    )


def frames_of(graph: Graph) -> dict[str, tuple[str, ...]]:
    """Returns by node the frames around it, the innermost first."""
    groups = {group.id: group for group in graph.groups}
    return {
        node.id: tuple(frame.id for frame in _around(node.group, groups)) for node in graph.nodes
    }


def _around(name: str, groups: dict[str, Group]) -> Iterator[Group]:
    while name in groups:
        yield groups[name]
        name = groups[name].parent


def _closed_around(name: str, groups: dict[str, Group], opened: Collection[str]) -> str:
    """Returns the outermost closed frame at or around a frame, empty for none."""
    closed = [group.id for group in _around(name, groups) if group.key not in opened]
    return closed[-1] if closed else ""


def _homes(graph: Graph, opened: Collection[str]) -> dict[str, str]:
    groups = {group.id: group for group in graph.groups}
    known = {group_id: _closed_around(group_id, groups, opened) for group_id in {"", *groups}}
    return {node.id: known.get(node.group, "") for node in graph.nodes}


@dataclass
class _Inside:
    """The contents of a closed frame."""

    boxes: Counter[str]
    findings: list[Finding]
    lines: int = 0
    frames: int = 0


def _insides(graph: Graph, homes: dict[str, str]) -> dict[str, _Inside]:
    """Returns the contents of closed frames, in the order of the frames."""
    insides: dict[str, _Inside] = defaultdict(lambda: _Inside(Counter(), []))
    seen: dict[str, set[str]] = defaultdict(set)
    for node in graph.nodes:
        if home := homes[node.id]:
            inside = insides[home]
            inside.boxes[node.kind] += 1
            inside.findings += node.findings
            for port in node.ports:
                inside.findings += port.findings
            if node.group != home:
                seen[home].add(node.group)
    for edge in graph.edges:
        ends = {homes.get(end.node, "") for end in (edge.source, edge.target)}
        for home in filter(None, ends):
            insides[home].lines += 1
            insides[home].findings += edge.findings
    for home, frames in seen.items():
        insides[home].frames = len(frames)
    return {group.id: insides[group.id] for group in graph.groups if group.id in insides}


def _closed(group: Group, inside: _Inside) -> Node:
    counts = [_count(number, _WORDS.get(kind, _OTHERS)) for kind, number in inside.boxes.items()]
    if inside.lines:
        counts.append(_count(inside.lines, _LINES))
    return Node(
        group.id,
        CLOSED,
        group.title,
        ", ".join(counts),
        group=group.parent,
        element=group.element,
        key=group.key,
        # How many frames are in it: those may be looked at from farther away than boxes.
        details=(("frames", str(inside.frames)),),
        findings=_gravest(inside.findings),
    )


def _gravest(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Returns one finding for all: as grave as the gravest, with how many there are of each."""
    distinct = dict.fromkeys(findings)
    worst = severity(tuple(distinct))
    if not worst:
        return ()
    counts = Counter(finding.severity for finding in distinct)
    summary = ", ".join(
        _count(counts[level], (level, f"{level}s"))
        for level in ("error", "warning")
        if counts[level]
    )
    return (Finding(worst, "", f"{summary or _count(counts['info'], ('hint', 'hints'))} in it"),)


def _count(number: int, words: tuple[str, str]) -> str:
    return f"{number} {words[number != 1]}"


def _edges(graph: Graph, homes: dict[str, str]) -> Iterator[Edge]:
    bundles: dict[tuple[End, End, str], list[Edge]] = defaultdict(list)
    for edge in graph.edges:
        source, target = homes.get(edge.source.node, ""), homes.get(edge.target.node, "")
        if not source and not target:
            yield edge
        elif source != target:
            start = End(source) if source else edge.source
            end = End(target) if target else edge.target
            bundles[start, end, edge.kind].append(edge)
    for (start, end, kind), edges in bundles.items():
        if len(edges) == 1:
            yield replace(edges[0], source=start, target=end)
        else:
            yield _bundle(start, end, kind, edges)


def _bundle(start: End, end: End, kind: str, edges: list[Edge]) -> Edge:
    first = edges[0]
    return Edge(
        f"{first.id}!bundle",
        start,
        end,
        kind,
        _count(len(edges), _LINES),
        count=len(edges),
        findings=_gravest(finding for edge in edges for finding in edge.findings),
        key=f"{first.key}!bundle",
    )
