"""Where the system view of a model shows what runs."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.authoring.studio.live_machines import machine_views
from jausml.language.metamodel.classes import bridge, jaus
from jausml.live.systems.state import node_of
from jausml.views.diagrams.bundling import framed, is_crowded
from jausml.views.diagrams.folding import frames_of, is_large
from jausml.views.diagrams.views import SYSTEM, graph_of, view_names
from jausml.views.diagrams.views.context import Context

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.studio.live_machines import Key, MachineView
    from jausml.language.model import Model
    from jausml.views.diagrams.graph import Graph


@dataclass(frozen=True)
class Places:
    """Where the page shows what a model has.

    `rows`: the row of a connection, by bridge and name. `controls`: edges of control, and the JAUS
    ids of who controls and who is controlled. `frames`: the frames around a box or a row, where
    they may be shown closed. `machines`: the views of a state machine, by service and name.
    """

    rows: Mapping[tuple[str, str], str] = field(default_factory=dict)
    edges: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    boxes: Mapping[str, str] = field(default_factory=dict)
    controls: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    frames: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    machines: Mapping[Key, tuple[MachineView, ...]] = field(default_factory=dict)


def places_of(model: Model) -> Places:
    """Returns where the system view of a model shows what."""
    if SYSTEM not in view_names(model, library=False):
        return Places()
    context = Context(model, SYSTEM, ())
    boxes = {
        context.id_of(each): str(each.address)
        for each in model.instances(jaus.Component, library=False)
        if each.address
    }
    edges: dict[str, list[str]] = defaultdict(list)
    controls = {}
    graph = graph_of(model, SYSTEM)
    for edge in graph.edges:
        for end in (edge.source, edge.target):
            edges[end.port].append(edge.id)
        ends = boxes.get(edge.source.node), boxes.get(edge.target.node)
        if edge.kind == "control" and ends[0] is not None and ends[1] is not None:
            controls[edge.id] = (ends[0], ends[1])
    rows = {
        (node_of(owner), str(each.name)): context.id_of(each)
        for owner in model.instances(bridge.Bridge, library=False)
        for each in (*owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections)
    }
    return Places(
        rows,
        {row: tuple(edges[row]) for row in rows.values()},
        {address: box for box, address in boxes.items()},
        controls,
        _frames(graph),
        machine_views(model),
    )


def _frames(graph: Graph) -> dict[str, tuple[str, ...]]:
    shown = framed(graph) if is_crowded(graph) else graph
    if not is_large(shown):
        return {}
    around = frames_of(shown)
    return {
        name: around[node.id]
        for node in shown.nodes
        for name in (node.id, *(port.id for port in node.ports))
    }
