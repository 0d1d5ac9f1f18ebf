"""Components with modelled behaviour: state machines (AS5684), or simulated reports."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar

from ..base.address import JausAddress
from ..services.access_control import Reject
from ..services.definitions import Guard, Status
from ..services.dispatch import Provision
from ..services.machine_states import MachineStatesService
from ..wire.message import EncodeError, Message
from .base import Component
from .state_machine import Action, Condition, State, StateMachine

LOGGER = logging.getLogger(__name__)

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)

_NOT_CONTROLLED = "Receiving.Ready.NotControlled"
_CONTROLLED = "Receiving.Ready.Controlled"
_NOT_AVAILABLE = {
    Status.INITIALIZE: f"{_NOT_CONTROLLED}.NotAvailable.Init",
    Status.FAILURE: f"{_NOT_CONTROLLED}.NotAvailable.Failure",
    Status.SHUTDOWN: f"{_NOT_CONTROLLED}.NotAvailable.Shutdown",
}
_WITHOUT_CONTROL = {"Events": "Receiving.Ready", "Transport": "Receiving"}
_STANDBY = f"{_CONTROLLED}.Available.Standby"
_RELEASED = f"{_NOT_CONTROLLED}.Available.Standby"


def _path(status: Status, *, controlled: bool) -> str:
    if status in _NOT_AVAILABLE:
        return _NOT_AVAILABLE[status]
    if status is Status.READY:
        return f"{_CONTROLLED}.Available.Ready"
    outer = _CONTROLLED if controlled else _NOT_CONTROLLED
    if status is Status.EMERGENCY:
        return f"{outer}.NotAvailable.Emergency"
    return f"{outer}.Available.Standby"


# Paths of states of ReceiveFSM by Management state and control (AS5710, Management).
CORE_STATES = {
    (status, controlled): _path(status, controlled=controlled)
    for status in Status
    for controlled in (False, True)
}


class ModelledComponent(Component):
    """A component with state machines.

    A generated component derives from this class if one of its services has a machine. In its
    constructor it adds the machines and registers their messages. Messages and internal events
    without a transition are ignored, as AS5684 demands, and counted as ``component.no_transition``.
    Guards, actions, entries and exits hold ``loop.lock`` and must not block. An error of one is
    logged and counted as ``component.handler_failed``; a guard that raises is false.
    """

    core_services = (*Component.core_services, MachineStatesService)
    _jaus_machines: tuple[StateMachine, ...] = ()
    _jaus_core_state = ""
    # Actions that have answered the present message: in earlier machines, and until now.
    _jaus_answered: frozenset[Action] = frozenset()
    _jaus_answers: frozenset[Action] = frozenset()

    def add_machine(
        self, name: str, states: Sequence[State], *, extends: str = "", service: str = ""
    ) -> StateMachine:
        """Adds a state machine, which runs from the start of the component on.

        Args:
            extends: The core service whose ReceiveFSM it extends: Management, AccessControl, Events
                or Transport. Its outer states are those of that service and change with them.
            service: Identifier of its service, for reports of MachineStates.
        """
        entered = self.part(MachineStatesService).watch(service, name)
        machine = StateMachine(name, states, self, extends=extends, entered=entered)
        self._jaus_machines = (*self._jaus_machines, machine)
        return machine

    def handle_by_machines(
        self, message_class: type[M], *, when: Guard | Callable[[M], Guard] = Guard.ANY
    ) -> None:
        """Lets the machines take an input message from senders that its guard allows."""
        self.handle(message_class, self._jaus_take, when=when)

    def provide_by_machines(
        self,
        query_class: type[Q],
        report_class: type[R],
        *makers: Callable[[Q, JausAddress], R | None],
    ) -> None:
        """Lets the machines answer a query, and serve events on it.

        For an event the report is made, but the transition is not taken.

        Args:
            makers: The actions of transitions that make the report.
        """
        provider = partial(self._jaus_report, makers)
        provision = Provision(query_class, report_class, provider)
        with self.loop.lock:
            self._jaus_router.set_provision(
                provision, lambda _provision, query, sender: self._jaus_take(query, sender)
            )

    def raise_event(self, name: str) -> None:
        """Lets the machines take an internal event, after a transition under way; any thread."""
        with self.loop.lock:
            taken = [machine.raise_event(name) for machine in self._jaus_machines]
            if not any(taken):
                self.counters.add("component.no_transition")

    # ---- guards of the core services --------------------------------------------------------

    def is_controlling_client(
        self, _message: Message | None = None, sender: JausAddress | None = None
    ) -> bool:
        """Returns whether the sender of the message is the controller (isControllingClient)."""
        return sender is not None and sender == self.controller

    def is_control_available(
        self, _message: Message | None = None, _sender: JausAddress | None = None
    ) -> bool:
        """Returns whether control may be requested now (isControlAvailable)."""
        return self.control_available

    def is_id_stored(
        self, _message: Message | None = None, sender: JausAddress | None = None
    ) -> bool:
        """Returns whether the sender has set an emergency that is not cleared (isIDStored)."""
        return sender in self._jaus_access.emergency_clients

    # ---- for the machines -------------------------------------------------------------------

    def core_state(self, of: str = "Management") -> str:
        """Returns the path of the core state, e.g. Receiving.Ready.Controlled.Available.Ready.

        The path for AccessControl ends with whether control is available.
        """
        if of == "Management":
            return CORE_STATES[self.status, self.controller is not None]
        if of == "AccessControl":
            outer = _NOT_CONTROLLED if self.controller is None else _CONTROLLED
            return f"{outer}.{'Available' if self.control_available else 'NotAvailable'}"
        return _WITHOUT_CONTROL[of]

    def request_core_state(self, path: str, of: str = "Management") -> None:
        """Enters the core state that a path is in, if the component may do so by itself.

        For Management these are Standby, with a controller or without, Failure and Shutdown. For
        AccessControl they are those without a controller, and those in which control is available
        or not. Other requests are counted as ``component.core_state_refused``.
        """
        if of == "AccessControl" and (self.controller or path.startswith(_NOT_CONTROLLED)):
            self.control_available = ".Available" in path
            if path.startswith(_NOT_CONTROLLED):
                self._jaus_access.drop(Reject.CONTROL_RELEASED)
        elif of != "Management":
            self.ignored("component.core_state_refused", path)
        elif path == _STANDBY or path.startswith(f"{_STANDBY}."):
            self._jaus_management.stand_by()
        elif path.startswith(_RELEASED) and self.status in (Status.STANDBY, Status.READY):
            self._jaus_access.drop(Reject.CONTROL_RELEASED)
        elif path.startswith(_NOT_AVAILABLE[Status.FAILURE]):
            self._jaus_management.fail(f"a state machine enters {path}")
        elif path.startswith(_NOT_AVAILABLE[Status.SHUTDOWN]):
            self._jaus_management.shut_down()
        else:
            self.ignored("component.core_state_refused", path)

    def core_event(self, name: str) -> None:
        """Lets the machines take an internal event of a core service."""
        for machine in self._jaus_machines:
            machine.raise_event(name)

    def core_state_changed(self) -> None:
        """Lets the machines follow the core services; called by these after each change."""
        former, self._jaus_core_state = self._jaus_core_state, self.core_state()
        has_changed = former != self._jaus_core_state
        if not former or (has_changed and self.status is Status.INITIALIZE):
            for machine in self._jaus_machines:
                machine.start()
            return
        if has_changed and self.status is Status.FAILURE:
            self.core_event("Failure")
        elif has_changed and former == _NOT_AVAILABLE[Status.INITIALIZE]:
            self.core_event("Initialized")
        for machine in self._jaus_machines:
            machine.follow()

    def run_condition(self, condition: Condition, arguments: tuple[Any, ...]) -> bool:
        """Evaluates a guard; returns False if it raises."""
        return bool(self.call(condition, *arguments))

    def run_action(self, action: Action, arguments: tuple[Any, ...]) -> None:
        """Runs an action and sends the message that it returns."""
        message = self.call(action, *arguments)
        if message is None or (arguments and action in self._jaus_answered):
            return
        self._jaus_answers |= {action}
        receiver = arguments[1] if arguments else self.controller
        if receiver is None:
            self.ignored("component.no_receiver", f"{message.NAME} of an event has no controller")
            return
        try:
            self.send(message, receiver)
        except EncodeError as error:
            self.ignored("component.report_not_encodable", str(error))

    def ignored(self, reason: str, detail: str) -> None:
        """Counts an effect that was ignored, by its reason."""
        self.counters.count(reason, detail)

    def _jaus_take(self, message: Message, sender: JausAddress) -> None:
        """Lets each machine take a message; an action of several machines answers it once."""
        is_taken = False
        self._jaus_answers = frozenset()
        for machine in self._jaus_machines:
            self._jaus_answered = self._jaus_answers
            is_taken = machine.receive(message, sender) or is_taken
        self._jaus_answered = frozenset()
        if not is_taken:
            self.counters.add("component.no_transition")

    def _jaus_report(
        self,
        makers: tuple[Callable[[Any, JausAddress], R | None], ...],
        query: Message,
        sender: JausAddress,
    ) -> R | None:
        for machine in self._jaus_machines:
            chosen = machine.chosen(query, sender)
            for action in chosen.do if chosen is not None else ():
                if action in makers:
                    return makers[makers.index(action)](query, sender)
        return None


class Simulation:
    """Stores the values of commands, and reports them.

    A component that the model calls ``simulated`` has one: it has no hardware, and each Report has
    the values of the Set of the same quantity (AS6009). Since nothing was measured, each report is
    counted as ``component.simulated``, and a warning is logged at the start.
    """

    def __init__(self, component: Component) -> None:
        self._component = component
        self._kept: dict[type[Message], dict[str, Any]] = {}
        component.when_started(self._warn)

    def keep(self, report_class: type[Message], **values: Any) -> None:
        """Stores values of a report by attribute, and sends events; None keeps the last value."""
        stated_values = {name: value for name, value in values.items() if value is not None}
        self._kept.setdefault(report_class, {}).update(stated_values)
        self._component.report_changed(report_class)

    def report(self, at_rest: R) -> R:
        """Returns the report `at_rest` with the stored values in place of its own."""
        for name, value in self._kept.get(type(at_rest), {}).items():
            setattr(at_rest, name, value)
        self._component.counters.add("component.simulated")
        return at_rest

    def _warn(self) -> None:
        LOGGER.warning(
            "%s is simulated: its reports say what it was told, and nothing of a machine",
            self._component.address,
        )
