"""State of a system as plain values for JSON, in a shape that docs/how-to/top.md describes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.live.systems.state import ComponentState, ConnectionState, SystemState

HEALTH = ("ok", "warning", "error")
"""Words for the weights of a state."""


def as_values(state: SystemState) -> dict[str, Any]:
    """Returns a state as objects, lists, texts and numbers."""
    return {
        "health": HEALTH[state.weight],
        "heard": state.is_heard,
        "sources": {name: fault or "heard" for name, fault in state.sources.items()},
        "connections": [_connection(each, state) for each in state.connections.values()],
        "components": [_component(each, state.now) for each in state.components.values()],
        "ignored": state.ignored,
    }


def _connection(connection: ConnectionState, state: SystemState) -> dict[str, Any]:
    declaration = connection.declaration
    return {
        "bridge": connection.bridge,
        "connection": connection.name,
        "jaus_id": connection.jaus_id,
        "level": connection.level.value,
        "state": connection.phase or None,
        "reason": connection.reason,
        "rate": connection.rate,
        "declared_rate": connection.declared_rate,
        "age": _rounded(state.age_of(connection)),
        "latency_us": dict(connection.latency),
        "drops": dict(connection.drops),
        "peers": dict(connection.peers),
        "history": list(connection.history),
        "told": _since(connection.told, state.now),
        "values": [list(pair) for pair in connection.values],
        "model": declaration
        and {
            "direction": declaration.direction,
            "message": declaration.message,
            "topics": {each.name: each.type for each in declaration.topics},
        },
    }


def _component(component: ComponentState, now: float) -> dict[str, Any]:
    trip = component.round_trip
    return {
        "id": component.address,
        "name": component.name,
        "type": component.type,
        "level": component.level.value,
        "reason": component.reason,
        "state": component.state or None,
        "controller": component.controller or None,
        "authority": component.authority,
        "control_timeout": component.control_timeout,
        "services": list(component.services),
        "round_trip_ms": None if trip is None else round(trip * 1e3, 3),
        "told": _since(component.told, now),
    }


def _rounded(seconds: float | None) -> float | None:
    return None if seconds is None else round(seconds, 3)


def _since(time: float | None, now: float) -> float | None:
    return None if time is None else round(max(0.0, now - time), 3)
