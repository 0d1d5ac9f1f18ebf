"""The present state of a running system, with reports from sources on other threads."""

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
from jausml.runtime.base.standstill import steady
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

ROUND = 1.0  # seconds between two rounds of queries; a component is queried once in a round

DISCOVERY = 10  # rounds between two broadcasts of Discovery

MOST_ASKED = 64  # components that are queried in one round; more take turns

_SELDOM = 10  # rounds between two queries of a component that does not answer

_UNANSWERED = 3


class JausObserver:
    """Observer that queries components on a thread of its own, and takes unasked reports, too."""

    def __init__(
        self,
        operator: Operator,
        declared: Iterable[JausAddress],
        take: Callable[[ComponentAnswer], None],
    ) -> None:
        """Sends nothing before `start`.

        Args:
            declared: Addresses of the components in the model.
            take: Is called with each answer.
        """
        self._operator = operator
        self._take = take
        self._known = dict.fromkeys(declared)
        self._senders: set[JausAddress] = set()
        self._query_times: dict[JausAddress, float] = {}
        self._failures: dict[JausAddress, int] = {}
        self._with_timeout: set[JausAddress] = set()
        self._answers: dict[JausAddress, ComponentAnswer] = {}
        self._unanswered_queries: dict[JausAddress, int] = {}
        self._subscriptions: dict[JausAddress, EventSubscription] = {}
        self._rounds_since_query: dict[JausAddress, int] = {}
        self._lives: dict[JausAddress, int] = {}
        self._turn = 0
        self._end = Event()
        self._thread = Thread(target=self._run, name="jaus observer", daemon=True)
        operator.on_report(ReportStatus, self._status)
        operator.on_report(ReportControl, self._control)
        operator.on_report(ReportTimeout, self._timeout)
        operator.on_report(ReportMachineStates, self._machines)

    def start(self) -> None:
        """Begins the queries."""
        self._thread.start()

    def stop(self) -> None:
        """Ends the queries and the subscriptions."""
        self._end.set()
        self._thread.join()
        for address in list(self._subscriptions):
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
            self._take_discovery()
            number += 1

    def _ask(self, number: int) -> None:
        """Queries states and controllers of the next components; notes missing answers."""
        for address in self._next(number):
            if self._query_times.pop(address, None) is not None:
                self._failures[address] = self._failures.get(address, 0) + 1
                if self._failures[address] == _UNANSWERED:
                    self._unfollow(address)
                self._with_timeout.discard(address)
                self._take(ComponentAnswer(str(address), source=AnswerSource.NOBODY))
            self._query_times[address] = time.perf_counter()
            self._operator.send(address, QueryStatus())
            self._operator.send(address, QueryControl())
            self._ask_machines(address)

    def _ask_machines(self, address: JausAddress) -> None:
        """Queries and subscribes to the machine states of a component that provides them.

        With a subscription a query is seldom sent, in case an event was lost.
        """
        answer = self._answers.get(address)
        services = answer.services if answer is not None else None
        if not any(service.startswith(f"{MACHINE_STATES}/") for service in services or ()):
            self._unfollow(address)
            return
        if address not in self._subscriptions:
            self._subscriptions[address] = self._operator.follow(
                address, QueryMachineStates(), ReportMachineStates, self._machines
            )
        self._rounds_since_query[address] = self._rounds_since_query.get(address, 0) + 1
        is_told = self._subscriptions[address].active and address not in self._unanswered_queries
        if is_told and self._rounds_since_query[address] < _SELDOM:
            return
        self._rounds_since_query[address] = 0
        self._unanswered_queries[address] = self._unanswered_queries.get(address, 0) + 1
        if self._unanswered_queries[address] > _UNANSWERED:
            self._take(ComponentAnswer(str(address), machines=(), source=AnswerSource.DISCOVERY))
        self._operator.send(address, QueryMachineStates())

    def _unfollow(self, address: JausAddress) -> None:
        followed = self._subscriptions.pop(address, None)
        if followed is not None:
            followed.cancel()

    def _next(self, number: int) -> list[JausAddress]:
        for sender in self._operator.senders():
            if sender != self._operator.own and sender not in self._senders:
                # A component that has just started need not wait for the next broadcast.
                self._operator.survey.ask(sender)
                self._senders.add(sender)
                self._known[sender] = None
        due = [
            address
            for index, address in enumerate(self._known)
            if self._failures.get(address, 0) < _UNANSWERED or (number + index) % _SELDOM == 0
        ]
        begin = self._turn % len(due) if due else 0
        self._turn = begin + MOST_ASKED
        return (due[begin:] + due[:begin])[:MOST_ASKED]

    def _take_discovery(self) -> None:
        """Takes what Discovery found out about components, as far as it has changed."""
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
        if control["controller"] and sender not in self._with_timeout:
            self._operator.send(sender, QueryTimeout())

    def _timeout(self, report: ReportTimeout, sender: JausAddress) -> None:
        self._with_timeout.add(sender)
        self._answered(sender, **timeout_in(report))

    def _machines(self, report: ReportMachineStates, sender: JausAddress) -> None:
        self._unanswered_queries.pop(sender, None)
        self._answered(sender, **machines_in(report))

    def _trip(self, sender: JausAddress) -> float | None:
        asked = self._query_times.pop(sender, None)
        return None if asked is None else time.perf_counter() - asked

    def _answered(self, sender: JausAddress, **fields: Any) -> None:
        if sender != self._operator.own:
            if self._failures.pop(sender, 0) >= _UNANSWERED:
                self._forget(sender)
            self._take(ComponentAnswer(str(sender), **fields))

    def _forget_replaced(self) -> None:
        """Forgets components that were replaced by others, by the numbers of their packets."""
        for address, number in self._operator.lives().items():
            if number > self._lives.get(address, 0):
                self._forget(address)
            self._lives[address] = number

    def _forget(self, address: JausAddress) -> None:
        """Forgets the services of a component: another one may have its address now."""
        self._unfollow(address)
        self._answers.pop(address, None)
        self._operator.survey.forget(address)
        self._operator.survey.ask(address)
        answer = ComponentAnswer(
            str(address), services=(), machines=(), source=AnswerSource.DISCOVERY
        )
        self._take(answer)


class Monitor:
    """The present state of a system; its times are those of `standstill.steady`."""

    def __init__(self, state: SystemState) -> None:
        """Begins with a state."""
        self._state = state
        self._lock = Lock()

    def state(self) -> SystemState:
        """Returns the present state."""
        with self._lock:
            self._state = fold_time(self._state, steady())
            return self._state

    def take_statuses(self, statuses: list[DiagnosticStatus]) -> None:
        """Folds the statuses of a message of `/diagnostics` into the state."""
        with self._lock:
            self._state = fold_statuses(self._state, statuses, steady())

    def take_answer(self, answer: ComponentAnswer) -> None:
        """Folds an answer about a component into the state."""
        with self._lock:
            self._state = fold_answer(self._state, answer, steady())

    def take_model(
        self, declarations: Iterable[DeclaredConnection], components: dict[str, str]
    ) -> None:
        """Folds the declarations of a changed model into the state."""
        with self._lock:
            self._state = fold_model(self._state, declarations, components, steady())

    def take_source(self, source: str, fault: str) -> None:
        """Notes that a source opened (empty `fault`), or why it failed to."""
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
    """Queries JAUS components as long as the block."""
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
            continue  # `jausml validate` reports addresses that are wrong
