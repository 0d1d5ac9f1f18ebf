"""Framing: a system of many connections with a frame for each bridge, and all its rows and lines.

A picture on paper bundles what is too much (`bundling`); a page that is edited shows each
connection, for what is not there cannot be changed.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.views.diagrams.graph import Group

if TYPE_CHECKING:
    from jausml.views.diagrams.graph import Graph

MOST_EDGES = 80
"""Edges that a drawing shows one by one without frames of its own."""

FRAME = "!frame"
"""Behind the id of a bridge: its frame."""


def is_crowded(graph: Graph, most: int = MOST_EDGES) -> bool:
    """Tells whether a graph has too many edges to be read without frames around its bridges."""
    return len(graph.edges) > most and any(each.kind == "bridge" for each in graph.nodes)


def framed(graph: Graph) -> Graph:
    """Returns a graph with a frame around each bridge and what exchanges most with it.

    What runs on another host than the bridge stays in the frame of its host.
    """
    homes = bridges_around(graph)
    nodes = graph.by_id
    bridges = [each for each in graph.nodes if each.kind == "bridge"]
    return replace(
        graph,
        nodes=tuple(
            replace(each, group=f"{home}{FRAME}")
            if (home := homes[each.id]) and nodes[home].group == each.group
            else each
            for each in graph.nodes
        ),
        groups=(
            *graph.groups,
            *(
                Group(f"{each.id}{FRAME}", "bridge", each.title, each.group, each.element,
                      f"{each.key}{FRAME}")
                for each in bridges
            ),
        ),
        is_crowded=True,
    )  # fmt: skip


def bridges_around(graph: Graph) -> dict[str, str]:
    """Returns by node the bridge that it exchanges most with; empty for none."""
    bridges = {each.id for each in graph.nodes if each.kind == "bridge"}
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for edge in graph.edges:
        for one, other in (
            (edge.source.node, edge.target.node),
            (edge.target.node, edge.source.node),
        ):
            if other in bridges:
                counts[one][other] += 1
    return {
        each.id: each.id
        if each.id in bridges
        else next((bridge for bridge, _ in counts[each.id].most_common(1)), "")
        for each in graph.nodes
    }
