"""Operator control unit: one JAUS component that queries, watches and commands others."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from itertools import count
from queue import Empty, SimpleQueue
from typing import Any

from jausml.live.messages import Catalogue, MessageEntry, UnknownMessageError
from jausml.live.peers.control import Handoffs, Hold
from jausml.live.peers.discovery import POLL, controller_of
from jausml.live.peers.heard import Heard
from jausml.live.peers.network import Network
from jausml.live.peers.query_client import NoAnswer, Refused, status_of
from jausml.live.peers.watching import AnsweringClient, ListingClient, WatchingClient
from jausml.runtime import (
    ComponentSettings,
    ControlState,
    HandoffDecision,
    HandoffRequest,
    JausComponent,
    Scope,
)
from jausml.runtime import messages as core_messages
from jausml.runtime.base.address import JausAddress
from jausml.runtime.component.process import running_transport
from jausml.runtime.services.definitions import CORE, ServiceIdentity, Status
from jausml.runtime.transports.delivery import Take
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.transports.transport import Transport
from jausml.runtime.wire.message import Message

OCU_TYPE = 20001  # type of an operator control unit (AS5710, ReportIdentification)

_WATCH = 0.5  # seconds between two queries of the state of a controlled component

_STOP = 1  # code of the only emergency (AS5710, SetEmergency)

# Commands by which a component leaves Ready (AS5710, Management).
_LEAVING_READY = ("Reset", "Shutdown", "Standby")

_ACCESS_CONTROL = f"{CORE}AccessControl"

_SERVICES = (
    *(
        ServiceIdentity(CORE + name, 1, 1)
        for name in ("Transport", "Events", "Liveness", "Discovery")
    ),
    ServiceIdentity("urn:jaus:jss:iop:HandoffController", 1, 1),
)


@dataclass(frozen=True)
class Identity:
    """Name, services and type (AS5710, ReportIdentification) of a component of ours."""

    name: str = "jausml ocu"
    services: tuple[ServiceIdentity, ...] = _SERVICES
    component_type: int = OCU_TYPE


class Operator(AnsweringClient, WatchingClient, ListingClient):
    """The actions of an operator; most of them wait for their outcome.

    Attributes:
        handoffs: Requests for handoff of control.
    """

    def __init__(self, component: _OperatorComponent, *others: Any) -> None:
        """Use `running_operator` instead."""
        super().__init__(component, *others)
        self._holds: dict[JausAddress, Hold] = {}
        self.handoffs = component.handoffs
        self._rejections: SimpleQueue[JausAddress] = SimpleQueue()
        self._request_ids = count(1)
        component.on_message(core_messages.RejectControl, self._rejected)
        component.on_message(core_messages.ReportStatus, self._status_reported)

    # ---- control ----------------------------------------------------------------------------

    def control(
        self, target: JausAddress, authority: int, on_change: Callable[[str], None] | None = None
    ) -> Hold:
        """Requests control and keeps it until `release`.

        Args:
            on_change: Is called with later changes in words, on the loop's thread.

        Raises:
            NoAnswer: The component does not answer.
            Refused: It gives no control.
        """
        self._forget(target)
        hold = Hold(target, on_change)
        with self._component.loop.lock:  # no answer is taken before the hold is known
            hold.session = self._component.control(
                target, authority=authority, resume=False, on_change=hold.changed
            )
            self._holds[target] = hold
        state = hold.answer(self.timeout)
        if state is None:
            self._forget(target)
            raise self.unanswered(target, "RequestControl", "ConfirmControl")
        if state is ControlState.REFUSED:
            self._forget(target)
            raise Refused(f"{target} gives no control: {self._refusal_text(target)}")
        return hold

    def request_handoff(
        self,
        target: JausAddress,
        authority: int,
        explanation: str,
        on_change: Callable[[str], None] | None = None,
    ) -> Hold:
        """Requests a handoff from the controller of a component, and keeps control once granted.

        Raises:
            NoAnswer: The component does not answer.
            Refused: The request is denied, or no control is given afterwards.
        """
        self.handoffs.request(
            target,
            authority,
            explanation,
            lambda: self.unanswered(target, "RequestHandoff", "ConfirmHandoffRequest"),
            self.timeout,
        )
        return self.control(target, authority, on_change)

    def decide_handoff(self, target: JausAddress, number: int, decision: HandoffDecision) -> str:
        """Sends a decision on a request for handoff; granting it ends our control.

        Returns:
            The JAUS id of the requester.
        """
        request = self.handoffs.decide(target, number, decision)
        if decision is HandoffDecision.GRANTED:
            self._forget(target)
        return str(request.client)

    def change(
        self,
        target: JausAddress,
        message: Message,
        *states: Status,
        gate: AbstractContextManager[None] | None = None,
    ) -> Status | None:
        """Sends a command of Management and waits for one of `states`, which it returns.

        It is repeated until it is acknowledged, except a Resume, which could come after a stop.
        Without a report of the state, it returns None.

        Args:
            gate: Is held while it is sent, and may refuse it.

        Raises:
            Refused: The component stays in another state.
        """
        if Status.READY not in states and target in self._holds:
            self._holds[target].expect_standby()
        is_urgent = isinstance(message, core_messages.SetEmergency | core_messages.ClearEmergency)
        with gate or nullcontext():
            self._component.send(
                message,
                target,
                priority=Priority.SAFETY_CRITICAL if is_urgent else Priority.STANDARD,
                acknowledge=not isinstance(message, core_messages.Resume),
            )
        end = time.monotonic() + self.timeout
        while True:
            try:
                state = status_of(
                    self.ask(target, core_messages.QueryStatus(), core_messages.ReportStatus)
                )
            except NoAnswer:
                return None
            if state in states:
                return state
            if time.monotonic() > end:
                name = state.name if state is not None else "an unknown state"
                raise Refused(f"{target} stays in {name} after {message.NAME}")
            time.sleep(POLL)

    def emergency(self, target: JausAddress) -> Status | None:
        """Sets an emergency, which stops a component, also without control."""
        return self.change(
            target, core_messages.SetEmergency(emergency_code=_STOP), Status.EMERGENCY
        )

    def clear(
        self, target: JausAddress, gate: AbstractContextManager[None] | None = None
    ) -> Status | None:
        """Clears our emergency (`Refused`: it lasts, as another component has set one, too)."""
        after = [status for status in Status if status is not Status.EMERGENCY]
        message = core_messages.ClearEmergency(emergency_code=_STOP)
        return self.change(target, message, *after, gate=gate)

    def send(self, target: JausAddress, message: Message, *, acknowledge: bool = False) -> None:
        """Sends a message, once and without waiting."""
        hold = self._holds.get(target)
        if hold is not None:
            hold.count()
            if message.NAME in _LEAVING_READY:
                hold.expect_standby()
        self._component.send(message, target, acknowledge=acknowledge)

    def answered(self, target: JausAddress, message: Message) -> None:
        """Notes that a message was answered, which counts as its acknowledgement."""
        self._component.transport.answered(self.own, target, message.encode())

    def awaiting(
        self, target: JausAddress, codes: Collection[int]
    ) -> AbstractContextManager[SimpleQueue[bytes]]:
        """Yields the messages of some codes that come from a component during the block."""
        return self._heard.awaiting(target, codes)

    def next_request_id(self) -> int:
        """Returns a number that identifies a request in its answer, from 0 to 255."""
        return next(self._request_ids) % 256

    def controls(self, target: JausAddress) -> bool:
        """Returns whether we control a component."""
        return target in self._holds and self._holds[target].is_held

    def check_obeyed(self, target: JausAddress, entry: MessageEntry) -> None:
        """Checks that a command may have an effect on a component.

        Raises:
            NoAnswer: No message ever came from the component, and it does not report its state.
            Refused: We do not control it, or it no longer obeys us.
        """
        hold = self._holds.get(target)
        is_core = any(service.urn.startswith(CORE) for service in entry.services)
        if hold is not None and not (hold.is_held if is_core else hold.is_obeyed):
            raise Refused(self._loss_text(hold))
        if self.is_on_its_thread:
            return  # the thread must not wait
        if not self._heard.of(target):
            self.status(target)
        if hold is None and self._needs_control(target, entry):
            reason = self.why_ignored(target)
            raise Refused(
                f"{target} takes {entry.name} from its controller alone"
                + (f": {reason}" if reason else ", and we do not control it")
            )

    def _loss_text(self, hold: Hold) -> str:
        text = f"{hold.target} {hold.last_change or 'does not obey us'}"
        session = hold.session
        if session is None:
            return text
        if session.status not in (None, Status.READY):
            return f"{text}: it is in {session.status.name}"
        if session.controller not in (None, self.own):
            return f"{text}: {session.controller} controls it"
        return text

    def needs_control(self, target: JausAddress, name: str) -> bool:
        """Returns whether a component takes a message only from its controller."""
        try:
            return self._needs_control(target, self.find(target, name))
        except UnknownMessageError:
            return False  # the common part of a query and its report

    def _needs_control(self, target: JausAddress, entry: MessageEntry) -> bool:
        if not entry.relations.is_for_controller:
            return False
        provided = [service.urn for service in self.services(target)]
        return not provided or _ACCESS_CONTROL in provided

    def why_ignored(self, target: JausAddress) -> str:
        """Returns the reason why a component may not obey, in words; empty if none is known."""
        try:
            return self._obstacle(target)
        except NoAnswer:
            return ""

    def _obstacle(self, target: JausAddress) -> str:
        state, control = self.status(target)
        if state not in (None, Status.READY, Status.STANDBY):
            return f"it is in {state.name}"
        controller = controller_of(control) if control is not None else ""
        if control is not None and control.subsystem_id and controller != str(self.own):
            return (
                f"{controller} controls it with authority {control.authority_code}; "
                "a higher authority preempts"
            )
        if state is Status.STANDBY and self.controls(target):
            return "it is in STANDBY, and obeys in READY"
        return ""

    @property
    def holds(self) -> tuple[Hold, ...]:
        """The components whose control was granted to us, also if it was lost since."""
        return tuple(self._holds.values())

    def release(self, target: JausAddress) -> bool:
        """Releases control, and returns whether the component confirms it."""
        while not self._rejections.empty():
            self._rejections.get_nowait()
        hold = self._holds.get(target)
        if hold is None:
            return False
        # It has reported another controller, and answers a release of its controller only.
        is_refused = hold.session is not None and hold.session.state is ControlState.REFUSED
        self._forget(target)
        if is_refused:
            return True
        end = time.monotonic() + self.timeout
        try:
            while self._rejections.get(timeout=max(0.0, end - time.monotonic())) != target:
                continue
        except Empty:
            return False
        return True

    def _forget(self, target: JausAddress) -> None:
        hold = self._holds.pop(target, None)
        if hold is not None and hold.session is not None:
            hold.session.release()

    def _rejected(self, _message: core_messages.RejectControl, sender: JausAddress) -> None:
        self._rejections.put(sender)
        if sender in self._holds:
            self._holds[sender].rejected()

    def _status_reported(self, report: core_messages.ReportStatus, sender: JausAddress) -> None:
        if sender in self._holds:
            self._holds[sender].status_reported(report)

    def _refusal_text(self, target: JausAddress) -> str:
        try:
            reason = self._obstacle(target)
        except NoAnswer:
            return "it does not say why"
        return reason or "the authority is below its default; try a higher authority"


@contextmanager
def running_operator(
    network: Network,
    catalogue: Catalogue,
    timeout: float = 3.0,
    identity: Identity | None = None,
    prepare: Callable[[Operator], None] | None = None,
) -> Iterator[Operator]:
    """Yields an operator on the network; releases control and cancels events at the end.

    Args:
        timeout: Seconds that a query waits for its report.
        prepare: Is called with the operator before its component starts.
    """
    ours = identity or Identity()
    with running_transport(network.settings) as transport:
        heard = Heard(catalogue, network, transport.counters)
        component = _OperatorComponent(
            heard,
            transport,
            network.own,
            name=ours.name,
            services=ours.services,
            component_type=ours.component_type,
            settings=ComponentSettings(
                discovery_scope=Scope.SUBSYSTEM, register_services=False, watch_interval=_WATCH
            ),
        )
        operator = Operator(component, network, catalogue, heard, timeout)
        if prepare is not None:
            prepare(operator)
        component.start()
        try:
            yield operator
        finally:
            component.stop()


class _OperatorComponent(JausComponent):
    """A component that notes all received messages, also those of none of its services."""

    def __init__(self, heard: Heard, transport: Transport, *arguments: Any, **others: Any) -> None:
        self._heard = heard
        super().__init__(transport, *arguments, **others)
        self.handoffs = Handoffs(self)

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        self.handoffs.take_requests(target, requests)

    def _jaus_dispatcher(self) -> Take:
        take, note = super()._jaus_dispatcher(), self._heard.note

        def noting(payload: bytes, sender: JausAddress) -> None:
            note(payload, sender)
            take(payload, sender)

        return noting


_TIMEOUT_S = 1.0


def check_peers(network: Network, catalogue: Catalogue) -> list[tuple[str, str, str]]:
    """Queries the peers of a network one by one; returns tuples of JAUS id, verdict and text.

    Verdicts are `ok`, `note` for a quirk of a peer, and `error` for a silent one.
    """
    verdicts: list[tuple[str, str, str]] = []
    with running_operator(network, catalogue, _TIMEOUT_S) as operator:
        for peer in network.settings.address_book:
            try:
                services = operator.meet(peer)
            except NoAnswer as error:
                verdicts.append((str(peer), "error", str(error)))
                continue
            count = f"{len(services)} services" if services else "no services that it tells of"
            verdicts.append((str(peer), "ok", f"answers; {count}"))
            learnt = [quirk for quirk in operator.quirks() if quirk[0] == peer]
            verdicts += [(str(peer), "note", str(quirk)) for _, quirk in learnt]
    return verdicts
