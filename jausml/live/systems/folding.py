"""Functions that fold reports of a system into its state: each returns the next state.

A report changes only the parts that it concerns; `fold_time` checks all parts. Bridges report in
statuses of `/diagnostics` (`bridge/connections/reporting.py`).
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from jausml.live.systems.machines import MachineState
from jausml.live.systems.state import (
    HISTORY,
    SILENCE,
    ComponentState,
    ConnectionState,
    DeclaredConnection,
    Level,
    SystemState,
)

_LEVELS = (Level.OK, Level.WARNING, Level.ERROR, Level.STALE)
_DECLARED = "declared rate (Hz)"
_OF_A_BRIDGE = (
    "jaus greetings",
    "jaus id",
    "jaus socket",
    "jaus state",
    "jaus traffic",
    "simulated time",
)
_LATENCY = re.compile(r"((?:source to bridge|in the bridge) (?:p50|p99|max)) \(us\)")
_OF_A_PEER = "account of "
# Prefixes of the counts of dropped messages, of failed calls, and of messages that reached no
# connection.
_FAILURES = ("dropped: ", "failed: ", "not taken: ")

_LOSSES = (
    "dropped by the kernel",
    "lost in queue",
    "lost on the way",
    "lost on the way, at most",
    "missed",
    "out of order",
    "too old",
)
_JAUS_ID = re.compile(r"\d{1,5}\.\d{1,3}\.\d{1,3}")
_COUNT = re.compile(r"\d{1,18}")
_PEERS = ("peer", "search")
_OF_A_CONNECTION = {_DECLARED, "translation"}

MOST_VALUES = 256  # values of one status; further ones are left out
LONGEST_TEXT = 500  # characters of one text; longer ones are cut
MOST_CONNECTIONS = 4096  # of a system; further ones are counted as ignored
MOST_COMPONENTS = 1024  # of a system; further ones are counted as ignored

# Seconds without an answer after which a component that no model declares is removed.
FORGOTTEN = 60.0

_PERIODS = 3  # missing statuses after which a bridge is gone
_ANSWERED = (
    *("name", "type", "state", "controller", "authority", "control_timeout", "services"),
    *("machines", "round_trip"),
)
_UNANSWERED = 3  # queries after which a component is gone
_STATES = {
    "READY": Level.OK,
    "STANDBY": Level.OK,
    "INITIALIZE": Level.WARNING,
    "SHUTDOWN": Level.WARNING,
    "EMERGENCY": Level.ERROR,
    "FAILURE": Level.ERROR,
}


@dataclass(frozen=True, slots=True)
class DiagnosticStatus:
    """A `diagnostic_msgs/msg/DiagnosticStatus` (`level`: 0 OK, 1 WARN, 2 ERROR, 3 STALE)."""

    level: int
    name: str
    message: str = ""
    hardware_id: str = ""
    values: tuple[tuple[str, str], ...] = ()


def connection_of(status: DiagnosticStatus, now: float) -> ConnectionState | None:
    """Returns the state of the connection or bridge in a status; None for other statuses.

    A value that is not of the expected form is left out; `values` has its text all the same.
    """
    bridge, colon, name = status.name.rpartition(": ")
    values = tuple((cut(key), cut(value)) for key, value in status.values[:MOST_VALUES])
    by_name = dict(values)
    concerns_bridge = name in _OF_A_BRIDGE or name.startswith(_OF_A_PEER)
    peers = {key: value for key, value in values if key.partition(" ")[0] in _PEERS}
    is_known = colon and (concerns_bridge or peers or not _OF_A_CONNECTION.isdisjoint(by_name))
    if not is_known or not _JAUS_ID.fullmatch(status.hardware_id):
        return None
    known = 0 <= status.level < len(_LEVELS)
    return ConnectionState(
        bridge=cut(bridge),
        name=cut(name),
        jaus_id=status.hardware_id,
        level=_LEVELS[status.level] if known else Level.ERROR,
        phase=by_name.get("state", "") if not concerns_bridge else "",
        reason=cut(status.message),
        rate=number(by_name.get("rate (Hz)", "")),
        declared_rate=number(by_name.get(_DECLARED, "")) or None,
        age=number(by_name.get("age (s)", "")),
        told=now,
        drops=_drops(values),
        latency=_latency(values),
        peers=peers,
        values=values,
        concerns_bridge=concerns_bridge,
    )


def number(text: str) -> float | None:
    """Returns the number in a text; None if it is not a finite number."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def cut(text: str) -> str:
    """Returns a text, cut to `LONGEST_TEXT` characters."""
    return text if len(text) <= LONGEST_TEXT else text[: LONGEST_TEXT - 1] + "…"


def _drops(values: Iterable[tuple[str, str]]) -> dict[str, int]:
    counts: Counter[str] = Counter()
    for key, value in values:
        is_failure = key.startswith(_FAILURES)
        if (is_failure or key in _LOSSES) and _COUNT.fullmatch(value) and int(value):
            counts[key.partition(": ")[2] if is_failure else key] += int(value)
    return dict(counts)


def _latency(values: Iterable[tuple[str, str]]) -> dict[str, float]:
    latencies = {}
    for key, value in values:
        match, figure = _LATENCY.fullmatch(key), number(value)
        if match is not None and figure is not None:
            latencies[match[1]] = figure
    return latencies


class AnswerSource(Enum):
    """The source of an answer about a component."""

    ITSELF = "itself"
    DISCOVERY = "Discovery"
    NOBODY = "nobody"
    """No answer came in time."""


@dataclass(frozen=True, slots=True)
class ComponentAnswer:
    """An answer about a component; attributes that it does not report are None.

    Attributes:
        round_trip: Seconds from the query to the report.
    """

    address: str
    name: str | None = None
    type: str | None = None
    state: str | None = None
    controller: str | None = None
    authority: int | None = None
    control_timeout: int | None = None
    services: tuple[str, ...] | None = None
    machines: tuple[MachineState, ...] | None = None
    round_trip: float | None = None
    source: AnswerSource = AnswerSource.ITSELF


def expected(
    declarations: Iterable[DeclaredConnection], components: Mapping[str, str], now: float
) -> SystemState:
    """Returns the state of a system by its model alone, before any report."""
    declared = tuple(declarations)
    state = SystemState(
        now,
        {
            connection.key: ConnectionState(
                connection.bridge,
                connection.name,
                connection.jaus_id,
                declared_rate=connection.rate,
                declaration=connection,
            )
            for connection in declared
        },
        {
            address: ComponentState(address, name, is_declared=True)
            for address, name in components.items()
        },
        declarations=declared,
    )
    return fold_time(state, now)


def fold_model(
    state: SystemState,
    declarations: Iterable[DeclaredConnection],
    components: Mapping[str, str],
    now: float,
) -> SystemState:
    """Returns the state after a change of its model; all reports so far stay."""
    fresh = expected(declarations, components, now)
    heard = [connection for connection in state.connections.values() if connection.told is not None]
    declared = {connection.key: _declaration(fresh, connection) for connection in heard}
    heard_keys = {connection.key for connection in declared.values() if connection is not None}
    connections = {
        **{
            key: connection
            for key, connection in fresh.connections.items()
            if key not in heard_keys
        },
        **{
            connection.key: replace(connection, declaration=declared[connection.key])
            for connection in heard
        },
    }
    former = {
        address: replace(
            component,
            is_declared=address in components,
            name=components.get(address, component.name),
        )
        for address, component in state.components.items()
        if address in components or component.told is not None
    }
    state = replace(
        fresh,
        connections=connections,
        components={**fresh.components, **former},
        sources=state.sources,
        ignored=state.ignored,
    )
    return fold_time(state, now)


def fold_source(state: SystemState, source: str, fault: str) -> SystemState:
    """Returns the state after a source opened (empty `fault`), or failed to."""
    return fold_time(replace(state, sources={**state.sources, source: fault}), state.now)


def fold_statuses(
    state: SystemState, statuses: Iterable[DiagnosticStatus], now: float
) -> SystemState:
    """Returns the state after a message of `/diagnostics`."""
    connections, ignored = dict(state.connections), state.ignored
    for status in statuses:
        latest = connection_of(status, now)
        if latest is None:
            continue
        declaration = _declaration(state, latest)
        if latest.key not in connections and len(connections) >= MOST_CONNECTIONS:
            ignored += 1
            continue
        if declaration is not None:
            placeholder = connections.get(declaration.key)
            if placeholder is not None and placeholder.told is None:
                del connections[declaration.key]
        former = connections.get(latest.key)
        connections[latest.key] = replace(
            _with_history(former, latest, now), declaration=declaration
        )
    return replace(state, now=max(now, state.now), connections=connections, ignored=ignored)


def fold_answer(state: SystemState, answer: ComponentAnswer, now: float) -> SystemState:
    """Returns the state after an answer about a component."""
    former = state.components.get(answer.address)
    if former is None:
        if len(state.components) >= MOST_COMPONENTS:
            return replace(state, ignored=state.ignored + 1)
        former = ComponentState(answer.address)
    unanswered = former.unanswered + (answer.source is AnswerSource.NOBODY)
    is_live = answer.source is AnswerSource.ITSELF
    changes: dict[str, Any] = {
        name: cut(value) if isinstance(value, str) else value
        for name in _ANSWERED
        if (value := getattr(answer, name)) is not None
    }
    changes["told"] = now if is_live else former.told
    if answer.machines is not None:
        changes["machines_told"] = now
    changes["unanswered"] = 0 if is_live else unanswered
    latest = replace(former, **changes)
    components = {**state.components, answer.address: _component_with_level(state, latest)}
    return replace(state, now=max(now, state.now), components=components)


def fold_time(state: SystemState, now: float) -> SystemState:
    """Returns the state at a time: parts that were silent for long are marked as gone."""
    now = max(now, state.now)
    connections = {}
    for key, connection in state.connections.items():
        patience = max(SILENCE, _PERIODS * connection.period)
        is_gone = connection.told is not None and now - connection.told > patience
        if not (is_gone and connection.concerns_bridge):
            connections[key] = _with_level(state, connection, is_gone=is_gone)
    components = {
        address: _component_with_level(state, component)
        for address, component in state.components.items()
        if component.is_declared or component.told is None or now - component.told < FORGOTTEN
    }
    return replace(state, now=now, connections=connections, components=components)


def _declaration(state: SystemState, latest: ConnectionState) -> DeclaredConnection | None:
    """Returns the declaration of a connection by the id of its bridge, else by its node name."""
    node = latest.bridge.rpartition("/")[2]
    candidates = [
        declaration for declaration in state.declarations if declaration.name == latest.name
    ]
    same_id = (connection for connection in candidates if connection.jaus_id == latest.jaus_id)
    same_node = (
        connection for connection in candidates if connection.bridge.rpartition("/")[2] == node
    )
    return next(same_id, None) or next(same_node, None)


def _with_history(
    former: ConnectionState | None, latest: ConnectionState, now: float
) -> ConnectionState:
    history = former.history if former is not None else ()
    if latest.rate is not None:
        history = (*history, latest.rate)[-HISTORY:]
    before = former.told if former is not None else None
    return replace(latest, history=history, period=0.0 if before is None else now - before)


def _with_level(
    state: SystemState, connection: ConnectionState, *, is_gone: bool
) -> ConnectionState:
    if is_gone:
        reason = "its bridge says nothing any more"
        return replace(
            connection, level=Level.NOT_HEARD, phase="", reason=reason, rate=None, latency={}
        )
    if connection.told is None:
        fault = state.sources.get("ROS", "")
        level = Level.UNKNOWN if fault else Level.NOT_HEARD
        return replace(connection, level=level, reason=fault or "no bridge tells of it")
    return connection


def _without_state(component: ComponentState, level: Level) -> ComponentState:
    """Returns a component that no longer answers, without the state that it reported."""
    if component.is_gone and not component.state:
        return replace(component, level=level)
    was = f"; was in {component.state}" if component.state else ""
    return replace(
        component,
        level=level,
        reason=f"does not answer any more{was}",
        state="",
        controller=None,
        authority=None,
        control_timeout=None,
        machines=(),
        round_trip=None,
    )


def _component_with_level(state: SystemState, component: ComponentState) -> ComponentState:
    gone = Level.NOT_HEARD if component.is_declared else Level.STALE
    if component.told is None:
        fault = state.sources.get("JAUS", "")
        is_silent = component.unanswered > 0 or not component.is_declared
        level = gone if is_silent and not fault else Level.UNKNOWN
        said = "does not answer" if component.unanswered else "was not asked"
        return replace(component, level=level, reason=fault or said)
    if component.unanswered >= _UNANSWERED:
        return _without_state(component, gone)
    if not component.state:
        return replace(component, level=Level.OK, reason="tells no state")
    level = _STATES.get(component.state, Level.WARNING)
    return replace(component, level=level, reason=f"is in {component.state}")
