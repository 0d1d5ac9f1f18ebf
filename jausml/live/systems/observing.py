"""The present state of a running system, which sources on other threads feed."""

from __future__ import annotations

import time
from contextlib import contextmanager
from threading import Lock
from typing import TYPE_CHECKING

from jausml.live.peers.network import component_address
from jausml.live.ros import RosFault
from jausml.live.systems.folding import (
    fold_answer,
    fold_model,
    fold_source,
    fold_statuses,
    fold_time,
)
from jausml.live.systems.jaus_observer import JausObserver
from jausml.live.systems.ros_diagnostics import RosDiagnostics

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.live.peers.operator import Operator
    from jausml.live.systems.diagnostics import Status
    from jausml.live.systems.folding import Answer
    from jausml.live.systems.state import Declaration, SystemState
    from jausml.runtime.base.address import JausAddress


class Observation:
    """A state that goes on; its times are those of `time.monotonic`."""

    def __init__(self, state: SystemState) -> None:
        """Goes on from a state."""
        self._state = state
        self._lock = Lock()

    def state(self) -> SystemState:
        """Returns the state at present."""
        with self._lock:
            self._state = fold_time(self._state, time.monotonic())
            return self._state

    def take_statuses(self, statuses: list[Status]) -> None:
        """Takes a message of `/diagnostics`."""
        with self._lock:
            self._state = fold_statuses(self._state, statuses, time.monotonic())

    def take_answer(self, answer: Answer) -> None:
        """Takes what a component tells."""
        with self._lock:
            self._state = fold_answer(self._state, answer, time.monotonic())

    def take_model(self, declarations: Iterable[Declaration], components: dict[str, str]) -> None:
        """Takes what the model promises now that it has changed."""
        with self._lock:
            self._state = fold_model(self._state, declarations, components, time.monotonic())

    def take_source(self, source: str, fault: str) -> None:
        """Takes that a source opened, or why it could not."""
        with self._lock:
            self._state = fold_source(self._state, source, fault)


@contextmanager
def listening(observation: Observation) -> Iterator[RosDiagnostics | None]:
    """Listens to `/diagnostics` as long as the block; yields None where there is no ROS."""
    ros = RosDiagnostics(observation.take_statuses)
    try:
        ros.start()
    except RosFault as error:
        observation.take_source("ROS", str(error))
        yield None
        return
    observation.take_source("ROS", "")
    try:
        yield ros
    finally:
        ros.stop()


@contextmanager
def asking(observation: Observation, operator: Operator) -> Iterator[None]:
    """Asks JAUS components as long as the block."""
    observation.take_source("JAUS", "")
    declared = _declared(observation.state())
    observer = JausObserver(operator, declared, observation.take_answer)
    observer.start()
    try:
        yield
    finally:
        observer.stop()


def _declared(state: SystemState) -> Iterator[JausAddress]:
    for each in state.components.values():
        try:
            yield component_address(each.address)
        except ValueError:
            continue  # what is no address is a finding of `jausml validate`
