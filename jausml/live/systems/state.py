"""State of a running system as values: declarations of its model, and reports of its parts.

Parts are its connections and components. A part that reported before and is silent now is gone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from jausml.live.systems.machines import MachineState, machines_as_json

HISTORY = 120  # rates in the history of a connection

SILENCE = 5.0  # seconds of silence after which a part is gone, unless its period is longer

HEALTH = ("ok", "warning", "error")  # words by weight


class Level(Enum):
    """How well a connection or a component works."""

    OK = "ok"
    UNKNOWN = "unknown"
    """A source that could report it is missing."""
    STALE = "stale"
    """It has no valid value: its source has not begun, or is lost."""
    WARNING = "warning"
    NOT_HEARD = "not heard"
    """The bridge of the connection, or the component, is silent."""
    ERROR = "error"

    @property
    def weight(self) -> int:
        """0 for a part that works, 1 for a warning or an unknown state, 2 for an error."""
        if self is Level.OK:
            return 0
        return 2 if self in (Level.NOT_HEARD, Level.ERROR) else 1


@dataclass(frozen=True, slots=True)
class TopicName:
    """A ROS topic of a connection, as its model names it.

    Attributes:
        is_absolute: Whether its name is the same in any namespace of its bridge.
    """

    name: str
    type: str
    is_absolute: bool = False


@dataclass(frozen=True, slots=True)
class DeclaredConnection:
    """A connection as a model declares it.

    Attributes:
        direction: `to ROS` or `to JAUS`.
        rate: Messages each second, None when the model states none.
        message: Name of the JAUS message.
        is_report: Whether it is a report, which can be queried, and no command.
        peers: JAUS ids of the components at the other end, as far as the model names them.
    """

    bridge: str
    name: str
    jaus_id: str
    rate: float | None
    direction: str
    topics: tuple[TopicName, ...]
    message: str
    is_report: bool
    peers: tuple[str, ...]

    @property
    def key(self) -> tuple[str, str]:
        """Bridge and name."""
        return self.bridge, self.name


@dataclass(frozen=True, slots=True)
class ConnectionState:
    """A connection of a bridge.

    Attributes:
        phase: Its state as its bridge names it, such as `silent`; empty before a status.
        age: Seconds since its last message at its last status.
        told: Time of its last status in seconds; None before the first.
        declared_rate: Messages each second by the model, None when it states no rate.
        period: Seconds between its last two statuses, 0 before there were two.
        latency: Measured latency in microseconds by name, such as `in the bridge p99`.
        drops: Numbers of dropped messages by counter.
        peers: States of its peers in words, by the keys of its status.
        values: All keys and values of its last status.
        concerns_bridge: Whether it is a status of the bridge itself, sent only in certain states.
    """

    bridge: str
    name: str
    jaus_id: str = ""
    level: Level = Level.NOT_HEARD
    phase: str = ""
    reason: str = ""
    rate: float | None = None
    declared_rate: float | None = None
    age: float | None = None
    told: float | None = None
    period: float = 0.0
    drops: Mapping[str, int] = field(default_factory=dict)
    latency: Mapping[str, float] = field(default_factory=dict)
    peers: Mapping[str, str] = field(default_factory=dict)
    values: tuple[tuple[str, str], ...] = ()
    history: tuple[float, ...] = ()
    concerns_bridge: bool = False
    declaration: DeclaredConnection | None = None

    @property
    def key(self) -> tuple[str, str]:
        """Bridge and name."""
        return self.bridge, self.name

    @property
    def is_gone(self) -> bool:
        """Whether its bridge reported it before, and is silent now."""
        return self.told is not None and self.level is Level.NOT_HEARD

    @property
    def dropped(self) -> int:
        """Number of lost messages."""
        return sum(self.drops.values())


@dataclass(frozen=True, slots=True)
class ComponentState:
    """A JAUS component.

    Attributes:
        controller: JAUS id of its controller, empty for none, None when it does not report one.
        authority: Authority code of its controller, else its default; None when unknown.
        control_timeout: Seconds after which control lapses unless it is requested again, 0 for
            never; None when unknown.
        machines: The state machines of its own services at its last report (MachineStates).
        machines_told: Time of that report in seconds.
        round_trip: Seconds from the last query to its report, None before the first one.
        told: Time of its last report in seconds; None before the first.
        unanswered: Number of queries since then without an answer.
    """

    address: str
    name: str = ""
    type: str = ""
    level: Level = Level.NOT_HEARD
    reason: str = ""
    state: str = ""
    controller: str | None = None
    authority: int | None = None
    control_timeout: int | None = None
    services: tuple[str, ...] = ()
    machines: tuple[MachineState, ...] = ()
    machines_told: float = 0.0
    round_trip: float | None = None
    told: float | None = None
    unanswered: int = 0
    is_declared: bool = False

    @property
    def present_machines(self) -> tuple[MachineState, ...]:
        """Its machines at its last report of any kind, as it reports machines on changes only."""
        since = max(0.0, (self.told or 0.0) - self.machines_told)
        return tuple(machine.later(since) for machine in self.machines)

    @property
    def is_gone(self) -> bool:
        """Whether it answered before, and is silent now."""
        return self.told is not None and self.level in (Level.NOT_HEARD, Level.STALE)


@dataclass(frozen=True, slots=True)
class SystemState:
    """A running system at one time.

    Attributes:
        sources: The faults of `ROS` and `JAUS`; empty while a source works.
        ignored: Number of parts beyond the limits.
    """

    now: float = 0.0
    connections: Mapping[tuple[str, str], ConnectionState] = field(default_factory=dict)
    components: Mapping[str, ComponentState] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    declarations: tuple[DeclaredConnection, ...] = ()
    ignored: int = 0

    def age_of(self, connection: ConnectionState) -> float | None:
        """Returns the seconds since the last message of a connection; None before the first.

        The age grows while the bridge is silent.
        """
        if connection.age is None or connection.told is None:
            return connection.age
        return connection.age + max(0.0, self.now - connection.told)

    @property
    def is_heard(self) -> bool:
        """Whether any part has reported."""
        return any(part.told is not None for part in self._parts())

    @property
    def weight(self) -> int:
        """The greatest weight of its parts; 2 if no part has reported."""
        return max(part.level.weight for part in self._parts()) if self.is_heard else 2

    def _parts(self) -> Iterator[ConnectionState | ComponentState]:
        yield from self.connections.values()
        yield from self.components.values()


def state_as_json(state: SystemState) -> dict[str, Any]:
    """Returns a state as JSON values."""
    heard = {
        name
        for name, parts in (("ROS", state.connections), ("JAUS", state.components))
        if any(part.told is not None for part in parts.values())
    }
    return {
        "health": HEALTH[state.weight],
        "heard": state.is_heard,
        "sources": {
            name: fault or ("heard" if name in heard else "nothing heard")
            for name, fault in state.sources.items()
        },
        "connections": [
            _connection(connection, state) for connection in state.connections.values()
        ],
        "components": [_component(component, state.now) for component in state.components.values()],
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
            "topics": {topic.name: topic.type for topic in declaration.topics},
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
        "machines": machines_as_json(component.present_machines),
        "round_trip_ms": None if trip is None else round(trip * 1e3, 3),
        "told": _since(component.told, now),
    }


def _rounded(seconds: float | None) -> float | None:
    return None if seconds is None else round(seconds, 3)


def _since(time: float | None, now: float) -> float | None:
    return None if time is None else round(max(0.0, now - time), 3)
