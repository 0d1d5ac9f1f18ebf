"""The state of a running system as values for the page, by ids of the system view."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jausml.language.metamodel.classes import bridge, jaus
from jausml.live.systems.declared import node_of
from jausml.live.systems.state import Level, state_as_json
from jausml.live.systems.tables import cell, state_text
from jausml.views.diagrams.views import SYSTEM, graph_of, view_names
from jausml.views.diagrams.views.context import Context

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from jausml.language.model import Model
    from jausml.live.systems.state import ComponentState, ConnectionState, SystemState

HISTORY = 30
"""Latest rates of a connection that the page is told."""


@dataclass(frozen=True)
class Places:
    """Where the page shows what a model has.

    Attributes:
        rows: The row of a connection, by bridge and name.
        controls: Edges of control, and the JAUS ids of who controls and who is controlled.
    """

    rows: Mapping[tuple[str, str], str] = field(default_factory=dict)
    edges: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    boxes: Mapping[str, str] = field(default_factory=dict)
    controls: Mapping[str, tuple[str, str]] = field(default_factory=dict)


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
    for edge in graph_of(model, SYSTEM).edges:
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
    )


def live_values(state: SystemState, places: Places) -> dict[str, Any]:
    """Returns what `jausml top --json` tells, and the same by ids of the system view.

    Connections have the id of their `row`, components that of their `box`; empty for none. What was
    told with each status in full is left to who asks about one connection.
    """
    values = state_as_json(state)
    for each, connection in zip(values["connections"], state.connections.values(), strict=True):
        del each["values"]
        each["history"] = each["history"][-HISTORY:]
        each["row"] = row_of(connection, places) or ""
    for each in values["components"]:
        each["box"] = places.boxes.get(each["id"], "")
    return {
        **values,
        "edges": {**_edges(state, places), **_controls(state, places)},
        "boxes": _boxes(state, places),
    }


def _edges(state: SystemState, places: Places) -> dict[str, Any]:
    found = {}
    for each in state.connections.values():
        row = row_of(each, places)
        if row is not None:
            shown = _edge(each, state.age_of(each))
            found.update(dict.fromkeys((row, *places.edges[row]), shown))
    return found


def row_of(connection: ConnectionState, places: Places) -> str | None:
    """Returns the row of a connection, None where the model has none."""
    declaration = connection.declaration
    return places.rows.get(connection.key if declaration is None else declaration.key)


def _edge(connection: ConnectionState, age: float | None) -> dict[str, Any]:
    return {
        "level": connection.level.value,
        "rate": connection.rate,
        "declared": connection.declared_rate,
        "age": age,
        "gone": connection.is_gone,
        "latency": dict(connection.latency),
        "drops": dict(connection.drops),
        "text": _connection_text(connection),
    }


def _connection_text(connection: ConnectionState) -> str:
    """Returns a few words for the diagram; why it is so stands in the table."""
    if connection.level is not Level.OK:
        return "gone" if connection.is_gone else state_text(connection)
    rate, declared = connection.rate, connection.declared_rate
    if rate is None:
        return state_text(connection)
    return f"{rate:.1f} Hz" if declared is None else f"{rate:.1f} of {declared:g} Hz"


def _controls(state: SystemState, places: Places) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for edge, (owner, controlled) in places.controls.items():
        component = state.components.get(controlled)
        if component is not None:
            level, text = _control(component, owner)
            found[edge] = {
                "level": level.value, "rate": None, "declared": None, "age": None,
                "gone": component.is_gone,
                "latency": {}, "drops": {}, "text": text,
            }  # fmt: skip
    return found


def _control(component: ComponentState, owner: str) -> tuple[Level, str]:
    """Returns how it stands with the control of a component by another."""
    if component.level in (Level.NOT_HEARD, Level.UNKNOWN) or component.controller is None:
        return Level.UNKNOWN, "nobody tells"
    if component.controller == owner:
        return Level.OK, "in control"
    return Level.STALE, f"controlled by {component.controller or 'nobody'}"


def _boxes(state: SystemState, places: Places) -> dict[str, Any]:
    complaints: dict[str, list[ConnectionState]] = defaultdict(list)
    for each in state.connections.values():
        if each.concerns_bridge and each.level is not Level.OK:
            complaints[each.jaus_id].append(each)
    return {
        box: _box(state.components[address], complaints[address])
        for address, box in places.boxes.items()
        if address in state.components
    }


def _box(component: ComponentState, complaints: Iterable[ConnectionState]) -> dict[str, Any]:
    """Returns how a component is; of a bridge also what it says of itself on `/diagnostics`."""
    level, texts = component.level, [_component_text(component)]
    for each in complaints:
        level = each.level if each.level.weight > level.weight else level
        texts.append(f"{each.name}: {each.reason}")
    return {
        "level": level.value,
        "gone": component.is_gone,
        "state": component.state,
        "controller": component.controller or "",
        "text": cell("; ".join(texts)),
    }


def _component_text(component: ComponentState) -> str:
    if component.is_gone:
        return f"gone: {component.reason}"
    if component.level in (Level.NOT_HEARD, Level.UNKNOWN, Level.STALE):
        return str(component.level.value)
    return component.state or component.reason
