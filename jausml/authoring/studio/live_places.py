"""Where the views of a model show what runs, and what state machines say there."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import Model
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inherited_machines import machine_with
from jausml.live.systems.declarations import node_of
from jausml.live.systems.machines import MachineState
from jausml.live.systems.state import SystemState
from jausml.live.systems.tables import cell, share_text
from jausml.views.diagrams.bundling import framed, is_crowded
from jausml.views.diagrams.folding import frames_of, is_large
from jausml.views.diagrams.graph import Graph
from jausml.views.diagrams.views import SYSTEM, graph_of, view_names
from jausml.views.diagrams.views.context import Context


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
        context.id_of(component): str(component.address)
        for component in model.instances(jaus.Component, library=False)
        if component.address
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
        (node_of(owner), str(bridge_connection.name)): context.id_of(bridge_connection)
        for owner in model.instances(bridge.Bridge, library=False)
        for bridge_connection in (
            *owner.bridgeConnections,
            *owner.serviceConnections,
            *owner.actionConnections,
        )
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


_ACTIVE, _AROUND, _LEFT = "active", "around", "left"
"""Levels of states: a machine is in it, or in a state inside it, or was so."""


@dataclass(frozen=True)
class MachineView:
    """The view of a machine: the prefix of the ids of its boxes, and the paths of its states."""

    start: str
    paths: tuple[str, ...]


Key = tuple[str, str]
"""URN of a service and name of its machine."""


def machine_views(model: Model) -> dict[Key, tuple[MachineView, ...]]:
    """Returns the views that show a machine: its own, and those of the machines it extends."""
    context = Context(model, SYSTEM, ())
    views_by_key: dict[Key, tuple[MachineView, ...]] = {}
    views: dict[jaus.StateMachine, MachineView] = {}
    for element in model.instances(jaus.StateMachine):
        whole, owner = machine_with(element), element.eContainer()
        if whole is not None and owner is not None and owner.urn not in SERVED_BY_RUNTIME:
            paths = dict.fromkeys((*whole.nodes, *whole.core_states))
            views[element] = MachineView(context.id_of(element), tuple(paths))
            shown = tuple(views[machine] for machine in whole.elements if machine in views)
            views_by_key[str(owner.urn), str(element.name)] = shown
    return views_by_key


def machine_boxes(
    state: SystemState, views: Mapping[Key, Sequence[MachineView]]
) -> dict[str, dict[str, Any]]:
    """Returns the states of boxes by id; those without a component in them are left out."""
    running: dict[MachineView, list[tuple[str, MachineState]]] = defaultdict(list)
    for component in state.components.values():
        for machine in component.present_machines:
            for view in views.get((machine.service, machine.machine), ()):
                running[view].append((component.name or component.address, machine))
    boxes = {}
    for view, instances in running.items():
        for path in view.paths:
            box = _box(path, instances)
            if box is not None:
                boxes[f"{view.start}!{path}"] = box
    return boxes


def _box(path: str, instances: Sequence[tuple[str, MachineState]]) -> dict[str, Any] | None:
    """Returns how a state is in all components together, None when none was ever in it."""
    machines = [state for _, state in instances]
    inside = [time for machine in machines for time in machine.times if _lies_in(time.state, path)]
    present = [(name, state) for name, state in instances if _lies_in(state.state, path)]
    is_innermost = any(state.state == path for _, state in present)
    if not inside and not present:
        return None
    words = []
    if len(instances) > 1 and present:
        names = ", ".join(name for name, _ in present)
        words.append(f"{len(present)} of {len(instances)}: {names}")
    elif is_innermost:
        words.append(f"{present[0][1].seconds:.1f} s")
    seconds, total = (
        sum(state_time.seconds for state_time in inside),
        sum(machine.total for machine in machines),
    )
    words.append(f"{share_text(seconds, total)} of the time")
    entries = sum(state_time.entries for state_time in inside if state_time.state == path)
    words += [f"entered {entries}×"] if entries else []
    return {
        "level": _ACTIVE if is_innermost else _AROUND if present else _LEFT,
        "gone": False,
        "text": cell("; ".join(words)),
    }


def _lies_in(path: str, outer: str) -> bool:
    return path == outer or path.startswith(f"{outer}.")


def is_known(machine: MachineState, views: Mapping[Key, Sequence[MachineView]]) -> bool:
    """Tells whether the model has the reported state of a machine."""
    shown = views.get((machine.service, machine.machine), ())
    return any(machine.state in view.paths for view in shown)
