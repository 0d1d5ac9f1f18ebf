"""The present state of a running system, which sources on other threads feed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from threading import Event, Lock, Thread
from typing import Any

from jausml.live.peers.discovery import label_of, type_name
from jausml.live.peers.network import component_address
from jausml.live.peers.operator import Operator
from jausml.live.ros.node import RosFault
from jausml.live.systems.folding import (
    AnswerSource,
    ComponentAnswer,
    DiagnosticStatus,
    fold_answer,
    fold_model,
    fold_source,
    fold_statuses,
    fold_time,
)
from jausml.live.systems.reports import control_in, machines_in, state_in, timeout_in
from jausml.live.systems.ros_diagnostics import RosDiagnostics
from jausml.live.systems.state import DeclaredConnection, SystemState
from jausml.runtime import EventSubscription
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import (
    QueryControl,
    QueryStatus,
    QueryTimeout,
    ReportControl,
    ReportStatus,
    ReportTimeout,
)
from jausml.runtime.messages.machine_states import (
    MACHINE_STATES,
    QueryMachineStates,
    ReportMachineStates,
)

ROUND = 1.0  # seconds from one round of questions to the next; no component is asked twice in one

DISCOVERY = 10  # rounds from one question to everybody to the next

MOST_ASKED = 64  # components that are asked in one round; more take turns

_SELDOM = 10  # rounds from one question to the next for a component that does not answer

_UNANSWERED = 3


class JausObserver:
    """Observer that asks components on a thread of its own, and notes other messages too."""

    def __init__(
        self,
        operator: Operator,
        declared: Iterable[JausAddress],
        take: Callable[[ComponentAnswer], None],
    ) -> None:
        """Asks nothing before `start`."""
        self._operator = operator
        self._take = take
        self._known = dict.fromkeys(declared)
        self._heard: set[JausAddress] = set()
        self._asked: dict[JausAddress, float] = {}
        self._failures: dict[JausAddress, int] = {}
        self._timed: set[JausAddress] = set()
        self._answers: dict[JausAddress, ComponentAnswer] = {}
        self._untold: dict[JausAddress, int] = {}
        self._followed: dict[JausAddress, EventSubscription] = {}
        self._quiet: dict[JausAddress, int] = {}
        self._lives: dict[JausAddress, int] = {}
        self._turn = 0
        self._end = Event()
        self._thread = Thread(target=self._run, name="jaus observer", daemon=True)
        operator.on_report(ReportStatus, self._status)
        operator.on_report(ReportControl, self._control)
        operator.on_report(ReportTimeout, self._timeout)
        operator.on_report(ReportMachineStates, self._machines)

    def start(self) -> None:
        """Begins to ask."""
        self._thread.start()

    def stop(self) -> None:
        """Asks no more."""
        self._end.set()
        self._thread.join()
        for address in list(self._followed):
            self._unfollow(address)

    def _run(self) -> None:
        number = 0
        while True:
            if number % DISCOVERY == 0:
                self._operator.survey.ask_all()
            else:
                self._ask(number)
            if self._end.wait(ROUND):
                return
            self._forget_replaced()
            self._tell_found()
            number += 1

    def _ask(self, number: int) -> None:
        """Asks the next components for their states and controllers."""
        for address in self._next(number):
            if self._asked.pop(address, None) is not None:
                self._failures[address] = self._failures.get(address, 0) + 1
                if self._failures[address] == _UNANSWERED:
                    self._unfollow(address)
                self._timed.discard(address)
                self._take(ComponentAnswer(str(address), source=AnswerSource.NOBODY))
            self._asked[address] = time.perf_counter()
            self._operator.send(address, QueryStatus())
            self._operator.send(address, QueryControl())
            self._ask_machines(address)

    def _ask_machines(self, address: JausAddress) -> None:
        """Asks for the states of machines, of components with that service alone.

        Who gives an event of them is asked seldom, in case that one of it was lost.
        """
        answer = self._answers.get(address)
        services = answer.services if answer is not None else None
        if not any(service.startswith(f"{MACHINE_STATES}/") for service in services or ()):
            self._unfollow(address)
            return
        if address not in self._followed:
            self._followed[address] = self._operator.follow(
                address, QueryMachineStates(), ReportMachineStates, self._machines
            )
        self._quiet[address] = self._quiet.get(address, 0) + 1
        is_told = self._followed[address].active and address not in self._untold
        if is_told and self._quiet[address] < _SELDOM:
            return
        self._quiet[address] = 0
        self._untold[address] = self._untold.get(address, 0) + 1
        if self._untold[address] > _UNANSWERED:
            self._take(ComponentAnswer(str(address), machines=(), source=AnswerSource.DISCOVERY))
        self._operator.send(address, QueryMachineStates())

    def _unfollow(self, address: JausAddress) -> None:
        followed = self._followed.pop(address, None)
        if followed is not None:
            followed.cancel()

    def _next(self, number: int) -> list[JausAddress]:
        for sender in self._operator.senders():
            if sender != self._operator.own and sender not in self._heard:
                # Who speaks at its start is not to wait for the next question to everybody.
                self._operator.survey.ask(sender)
                self._heard.add(sender)
                self._known[sender] = None
        due = [
            address
            for index, address in enumerate(self._known)
            if self._failures.get(address, 0) < _UNANSWERED or (number + index) % _SELDOM == 0
        ]
        begin = self._turn % len(due) if due else 0
        self._turn = begin + MOST_ASKED
        return (due[begin:] + due[:begin])[:MOST_ASKED]

    def _tell_found(self) -> None:
        """Reports the findings of Discovery about components, once."""
        for subsystem in self._operator.survey.known():
            for address, component in subsystem.components.items():
                services = tuple(map(label_of, component.services))
                answer = ComponentAnswer(
                    str(address),
                    name=component.identification or None,
                    type=type_name(component.type) or None,
                    services=services,
                    source=AnswerSource.DISCOVERY,
                )
                if self._answers.get(address) != answer:
                    self._answers[address] = answer
                    self._known.setdefault(address)
                    self._take(answer)

    def _status(self, report: ReportStatus, sender: JausAddress) -> None:
        self._answered(sender, round_trip=self._trip(sender), **state_in(report))

    def _control(self, report: ReportControl, sender: JausAddress) -> None:
        control = control_in(report)
        self._answered(sender, round_trip=self._trip(sender), **control)
        if control["controller"] and sender not in self._timed:
            self._operator.send(sender, QueryTimeout())

    def _timeout(self, report: ReportTimeout, sender: JausAddress) -> None:
        self._timed.add(sender)
        self._answered(sender, **timeout_in(report))

    def _machines(self, report: ReportMachineStates, sender: JausAddress) -> None:
        self._untold.pop(sender, None)
        self._answered(sender, **machines_in(report))

    def _trip(self, sender: JausAddress) -> float | None:
        asked = self._asked.pop(sender, None)
        return None if asked is None else time.perf_counter() - asked

    def _answered(self, sender: JausAddress, **fields: Any) -> None:
        if sender != self._operator.own:
            if self._failures.pop(sender, 0) >= _UNANSWERED:
                self._forget(sender)
            self._take(ComponentAnswer(str(sender), **fields))

    def _forget_replaced(self) -> None:
        """Forgets components that were replaced unseen, by the numbers of their packets."""
        for address, number in self._operator.lives().items():
            if number > self._lives.get(address, 0):
                self._forget(address)
            self._lives[address] = number

    def _forget(self, address: JausAddress) -> None:
        """Forgets a component that was gone: another one may have its place, and is asked anew."""
        self._unfollow(address)
        self._answers.pop(address, None)
        self._operator.survey.forget(address)
        self._operator.survey.ask(address)
        answer = ComponentAnswer(
            str(address), services=(), machines=(), source=AnswerSource.DISCOVERY
        )
        self._take(answer)


class Monitor:
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

    def take_statuses(self, statuses: list[DiagnosticStatus]) -> None:
        """Takes a message of `/diagnostics`."""
        with self._lock:
            self._state = fold_statuses(self._state, statuses, time.monotonic())

    def take_answer(self, answer: ComponentAnswer) -> None:
        """Folds an answer of a component into the state."""
        with self._lock:
            self._state = fold_answer(self._state, answer, time.monotonic())

    def take_model(
        self, declarations: Iterable[DeclaredConnection], components: dict[str, str]
    ) -> None:
        """Folds the declarations of a model that has changed into the state."""
        with self._lock:
            self._state = fold_model(self._state, declarations, components, time.monotonic())

    def take_source(self, source: str, fault: str) -> None:
        """Notes that a source opened, or why it could not."""
        with self._lock:
            self._state = fold_source(self._state, source, fault)


@contextmanager
def listening(monitor: Monitor) -> Iterator[RosDiagnostics | None]:
    """Listens to `/diagnostics` as long as the block; yields None where there is no ROS."""
    ros = RosDiagnostics(monitor.take_statuses)
    try:
        ros.start()
    except RosFault as error:
        monitor.take_source("ROS", str(error))
        yield None
        return
    monitor.take_source("ROS", "")
    try:
        yield ros
    finally:
        ros.stop()


@contextmanager
def polling(monitor: Monitor, operator: Operator) -> Iterator[None]:
    """Asks JAUS components as long as the block."""
    monitor.take_source("JAUS", "")
    declared = _declared(monitor.state())
    observer = JausObserver(operator, declared, monitor.take_answer)
    observer.start()
    try:
        yield
    finally:
        observer.stop()


def _declared(state: SystemState) -> Iterator[JausAddress]:
    for component in state.components.values():
        try:
            yield component_address(component.address)
        except ValueError:
            continue  # what is no address is a finding of `jausml validate`
