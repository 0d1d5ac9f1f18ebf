"""A running system, watched while a page looks: asked, listened to and told, never commanded."""

from __future__ import annotations

import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.live_places import Places, is_known, machine_boxes, places_of
from jausml.language.model import Model
from jausml.live.messages.of_project import messages_of
from jausml.live.peers.network import Network
from jausml.live.peers.operator import Operator
from jausml.live.systems.declarations import components_of, declarations_of
from jausml.live.systems.inspection import Inspection
from jausml.live.systems.ros_diagnostics import RosDiagnostics
from jausml.live.systems.running import LONGEST, RunningSystem
from jausml.live.systems.state import (
    ComponentState,
    ConnectionState,
    Level,
    SystemState,
    state_as_json,
)
from jausml.live.systems.tables import cell, state_text


def live_values(state: SystemState, places: Places) -> dict[str, Any]:
    """Returns the state as `jausml top --json` has it, and the same by ids of the system view.

    Connections have the id of their `row`, empty for none, and neither history nor what was told
    with each status. Boxes of states of machines are beside those of the system view.
    """
    values = state_as_json(state)
    for connection_entry, connection in zip(
        values["connections"], state.connections.values(), strict=True
    ):
        del connection_entry["values"], connection_entry["history"]
        connection_entry["row"] = row_of(connection, places) or ""
    for component_entry, component in zip(
        values["components"], state.components.values(), strict=True
    ):
        for machine_entry, machine in zip(
            component_entry["machines"], component.machines, strict=True
        ):
            machine_entry["known"] = is_known(machine, places.machines)
    edges, boxes = _edges(state, places), _boxes(state, places)
    return {
        **values,
        "edges": {**edges, **_controls(state, places)},
        "boxes": {
            **boxes,
            **_closed(edges, boxes, places),
            **machine_boxes(state, places.machines),
        },
    }


def _closed(
    edges: Mapping[str, Any], boxes: Mapping[str, Any], places: Places
) -> dict[str, dict[str, Any]]:
    """Returns how frames are: as the worst that is in them, with how many are how."""
    inside: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for name, status in (*boxes.items(), *edges.items()):
        for frame in places.frames.get(name, ()):
            inside[frame].append(status)
    return {frame: _worst(statuses) for frame, statuses in inside.items()}


def _worst(statuses: Sequence[dict[str, Any]]) -> dict[str, Any]:
    level = max(
        (Level(status["level"]) for status in statuses),
        key=lambda status_level: status_level.weight,
    )
    counts = Counter("gone" if status["gone"] else status["level"] for status in statuses)
    return {
        "level": level.value,
        "gone": bool(counts["gone"]),
        "text": ", ".join(f"{count} {word}" for word, count in sorted(counts.items())),
    }


def _edges(state: SystemState, places: Places) -> dict[str, Any]:
    edges_by_id = {}
    for connection in state.connections.values():
        row = row_of(connection, places)
        if row is not None:
            shown = _shown(connection, _connection_text(connection))
            edges_by_id.update(dict.fromkeys((row, *places.edges[row]), shown))
    return edges_by_id


def row_of(connection: ConnectionState, places: Places) -> str | None:
    """Returns the row of a connection, None where the model has none."""
    declaration = connection.declaration
    return places.rows.get(connection.key if declaration is None else declaration.key)


def _shown(
    part: ConnectionState | ComponentState, text: str, level: Level | None = None
) -> dict[str, Any]:
    """Returns the words that the diagram shows of a part: how it is, and a few facts."""
    return {"level": (level or part.level).value, "gone": part.is_gone, "text": text}


def _connection_text(connection: ConnectionState) -> str:
    """Returns a few words for the diagram; why it is so stands in the table."""
    if connection.level is not Level.OK:
        return "gone" if connection.is_gone else state_text(connection)
    rate, declared = connection.rate, connection.declared_rate
    if rate is None:
        return state_text(connection)
    return f"{rate:.1f} Hz" if declared is None else f"{rate:.1f} of {declared:g} Hz"


def _controls(state: SystemState, places: Places) -> dict[str, Any]:
    controls_by_edge: dict[str, Any] = {}
    for edge, (owner, controlled) in places.controls.items():
        component = state.components.get(controlled)
        if component is not None:
            level, text = _control(component, owner)
            controls_by_edge[edge] = _shown(component, text, level)
    return controls_by_edge


def _control(component: ComponentState, owner: str) -> tuple[Level, str]:
    """Returns how it stands with the control of a component by another."""
    if component.level in (Level.NOT_HEARD, Level.UNKNOWN) or component.controller is None:
        return Level.UNKNOWN, "nobody tells"
    if component.controller == owner:
        return Level.OK, "in control"
    return Level.STALE, f"controlled by {component.controller or 'nobody'}"


def _boxes(state: SystemState, places: Places) -> dict[str, Any]:
    complaints: dict[str, list[ConnectionState]] = defaultdict(list)
    for connection in state.connections.values():
        if connection.concerns_bridge and connection.level is not Level.OK:
            complaints[connection.jaus_id].append(connection)
    return {
        box: _box(state.components[address], complaints[address])
        for address, box in places.boxes.items()
        if address in state.components
    }


def _box(component: ComponentState, complaints: Iterable[ConnectionState]) -> dict[str, Any]:
    """Returns the state of a component; of a bridge also that of its own diagnostics."""
    level, texts = component.level, [_component_text(component)]
    for complaint in complaints:
        level = complaint.level if complaint.level.weight > level.weight else level
        texts.append(f"{complaint.name}: {complaint.reason}")
    return _shown(component, cell("; ".join(texts)), level)


def _component_text(component: ComponentState) -> str:
    if component.is_gone:
        return f"gone: {component.reason}"
    if component.level in (Level.NOT_HEARD, Level.UNKNOWN, Level.STALE):
        return str(component.level.value)
    return component.state or component.reason


GLANCE = 5.0
"""Seconds without a question for its last message after which a connection is looked at no more."""

_TIMEOUT = 1.0


class LiveSystem(RunningSystem):
    """A running system, from `start` to `stop`. Any thread may call its methods."""

    def __init__(
        self,
        path: Path,
        root: Path,
        model: Model,
        network: Network,
        notify: Callable[[dict[str, Any]], None],
    ) -> None:
        """Watches nothing before `start`.

        `path`: the file of the model. `root`: the folder with what it refers to. `notify`: takes
        the state as values for the page, on another thread: if it has changed, at most once in
        `PERIOD`, else once in `LONGEST`.
        """
        known = partial(messages_of, path, root)
        declared, named = declarations_of(model), components_of(model)
        super().__init__(network, declared, named, known, _TIMEOUT)
        self._notify = notify
        self._places = places_of(model)
        self._changed: Model | None = None
        self._is_wanted = False
        self._sent = 0.0
        self._before: tuple[object, ...] | None = None
        self._inspection: Inspection | None = None
        self._glanced: float | None = None
        self._lock = Lock()

    def follow(self, model: Model) -> None:
        """Goes on with the model as it is now, from the next look at the state on."""
        with self._lock:
            self._changed = model

    def tell_again(self) -> None:
        """Reports the state soon, changed or not: for a new page."""
        with self._lock:
            self._is_wanted = True

    def message(self, row: str) -> dict[str, Any]:
        """Returns the last message of a connection on both sides.

        The first question begins to look, so what comes is there at a later one.
        """
        connection, age = self._connection(row)
        with self._lock:
            if self._inspection is None:
                raise AnswerError("the system is not watched yet")
            ros, jaus = self._inspection.at(connection)
            self._glanced = time.monotonic()
        return {"ros": "\n".join(ros), "jaus": "\n".join(jaus), "age": age}

    def _connection(self, row: str) -> tuple[ConnectionState, float | None]:
        """Returns a connection and the age of its last message."""
        with self._lock:
            places = self._places
        state = self.monitor.state()
        for connection in state.connections.values():
            if row_of(connection, places) == row:
                return connection, state.age_of(connection)
        raise AnswerError("nothing is known of this connection")

    # ---- the thread -------------------------------------------------------------------------

    def _enter(self, operator: Operator | None, ros: RosDiagnostics | None) -> None:
        with self._lock:
            self._inspection = Inspection(operator, ros)

    def _leave(self) -> None:
        with self._lock:
            inspection, self._inspection = self._inspection, None
        if inspection is not None:
            inspection.close()

    def _look(self) -> None:
        """Reports the state if it has changed."""
        self._take_model()
        state = self.monitor.state()
        with self._lock:
            places = self._places
            is_wanted, self._is_wanted = self._is_wanted, False
            self._look_away()
        # Without its time, which alone is no change.
        present = (places, state.connections, state.components, state.sources, state.ignored)
        if is_wanted or present != self._before or state.now - self._sent >= LONGEST:
            self._sent = state.now
            self._notify(live_values(state, places))
        self._before = present

    def _take_model(self) -> None:
        with self._lock:
            model, self._changed = self._changed, None
        if model is not None:
            places = places_of(model)
            self.monitor.take_model(declarations_of(model), components_of(model))
            with self._lock:
                self._places = places

    def _look_away(self) -> None:
        """Stops watching a connection when no page asks for its last message any more."""
        if self._glanced is None or time.monotonic() - self._glanced < GLANCE:
            return
        self._glanced = None
        if self._inspection is not None:
            self._inspection.away()
