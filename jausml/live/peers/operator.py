"""Operator control unit: one JAUS component that asks, watches and commands others."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from jausml.live.peers.entry_messages import EntryMessage, full_query, message_class
from jausml.live.peers.heard import Heard
from jausml.live.peers.holding import Hold
from jausml.live.peers.query_client import POLL, NoAnswer, QueryClient, status_of
from jausml.live.peers.rendering import printable
from jausml.runtime import ComponentSettings, ControlState, JausComponent, Scope
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import QueryStatus, RejectControl, ReportStatus
from jausml.runtime.services.definitions import CORE, Guard, ServiceIdentity, Status
from jausml.runtime.transports.packets.packet import Priority

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jausml.live.messages import Catalogue, MessageEntry
    from jausml.live.peers.network import Network
    from jausml.runtime import EventSubscription
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.transports.delivery import Take
    from jausml.runtime.transports.transport import Transport
    from jausml.runtime.wire.message import Message

OCU_TYPE = 20001
"""Type of an operator control unit (AS5710, ReportIdentification)."""

_WATCH = 0.5
"""Seconds between two looks at a component that we control."""

_LATE_REPORTS = 3
"""Periodic reports that may be missing before it is told."""

_SERVICES = tuple(
    ServiceIdentity(CORE + name, 1, 1) for name in ("Transport", "Events", "Liveness", "Discovery")
)


@dataclass(frozen=True)
class Identity:
    """What a component of ours says of itself."""

    name: str = "jausml ocu"
    services: tuple[ServiceIdentity, ...] = _SERVICES
    component_type: int = OCU_TYPE


class Refused(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """A component answers, but not as wished."""


class Operator(QueryClient):
    """The actions of an operator; each call waits for its outcome."""

    def __init__(
        self,
        component: JausComponent,
        network: Network,
        catalogue: Catalogue,
        heard: Heard,
        timeout: float,
    ) -> None:
        """Use `running_operator` instead."""
        super().__init__(component, network, catalogue, heard, timeout)
        self._holds: dict[JausAddress, Hold] = {}
        self._rejections: SimpleQueue[JausAddress] = SimpleQueue()
        component.on_message(RejectControl, self._rejected)
        component.on_message(ReportStatus, self._status_reported)

    # ---- watching ---------------------------------------------------------------------------

    def watch(
        self,
        target: JausAddress,
        name: str,
        rate: float | None,
        on_report: Callable[[MessageEntry, dict[str, Any]], None],
    ) -> EventSubscription:
        """Subscribes to a report by an event.

        When periodic reports stay away, that is counted and logged.

        Args:
            rate: Reports each second; None means every change.
            on_report: Takes the report and its fields, on another thread.

        Raises:
            Refused: It gives no such event.
        """
        query, report = self.exchange(target, name)
        patience = max(self.timeout, _LATE_REPORTS / rate) if rate and rate > 0 else 0.0
        silence = f"no {report.name} of {target} for {patience:g} s"
        subscription = self._component.subscribe(
            target,
            self.message(query, full_query(query, report)),
            message_class(report),
            lambda message, _: on_report(report, message.fields),
            rate=rate,
            silence_timeout=patience,
            on_silence=lambda: self._component.counters.count("event_client.silent", silence),
        )
        return self._confirmed(target, subscription, report)

    def watch_encoded(
        self,
        target: JausAddress,
        exchange: tuple[MessageEntry, MessageEntry],
        rate: float | None,
        on_report: Callable[[bytes], None],
    ) -> EventSubscription:
        """Subscribes to a report by an event, to take it as it arrives, undecoded."""
        query, report = exchange
        subscription = self._component.subscribe(
            target,
            self.message(query, full_query(query, report)),
            message_class(report),
            lambda payload, _: on_report(payload),
            rate=rate,
            payloads=True,
        )
        return self._confirmed(target, subscription, report)

    def _confirmed(
        self, target: JausAddress, subscription: EventSubscription, report: MessageEntry
    ) -> EventSubscription:
        """Returns a subscription once its event is confirmed."""
        end = time.monotonic() + self.timeout
        while not subscription.active:
            if refusal := subscription.refusal:
                subscription.cancel()
                raise Refused(f"{target} refuses events of {report.name}: {printable(refusal)}")
            if time.monotonic() > end:
                subscription.cancel()
                raise self.unanswered(target, "CreateEvent")
            time.sleep(POLL)
        return subscription

    # ---- control ----------------------------------------------------------------------------

    def control(
        self,
        target: JausAddress,
        authority: int,
        on_change: Callable[[str], None] | None = None,
    ) -> Hold:
        """Takes control and keeps it until `release`.

        Args:
            on_change: Told in words what becomes of control afterwards, on another thread.

        Raises:
            Refused: It does not give control.
        """
        self._forget(target)
        hold = self._holds[target] = Hold(target, on_change)
        hold.session = self._component.control(
            target, authority=authority, resume=False, on_change=hold.changed
        )
        state = hold.answer(self.timeout)
        if state is None:
            self._forget(target)
            raise self.unanswered(target, "RequestControl", "ConfirmControl")
        if state is ControlState.REFUSED:
            self._forget(target)
            raise Refused(f"{target} gives no control: {self._why_refused(target)}")
        return hold

    def change(self, target: JausAddress, message: Message, state_after: Status) -> Status | None:
        """Sends Resume or Standby and returns the state that follows; None without Management.

        Raises:
            Refused: The component does not come to the state.
        """
        try:
            state = status_of(self.ask(target, QueryStatus(), ReportStatus))
        except NoAnswer:
            return None
        if state_after is not Status.READY and target in self._holds:
            self._holds[target].expect_standby()
        self._component.send(message, target)
        end = time.monotonic() + self.timeout
        while state is not state_after:
            if time.monotonic() > end:
                raise Refused(
                    f"{target} stays in {state.name if state is not None else 'an unknown state'} "
                    f"after {message.NAME}"
                )
            state = status_of(self.ask(target, QueryStatus(), ReportStatus))
        return state

    def send(
        self, target: JausAddress, message: Message, priority: Priority = Priority.STANDARD
    ) -> None:
        """Sends a message, once and without waiting."""
        if target in self._holds:
            self._holds[target].count()
        self._component.send(message, target, priority=priority)

    # ---- answering --------------------------------------------------------------------------

    def provide(
        self,
        query: MessageEntry,
        report: MessageEntry,
        give: Callable[[], dict[str, Any] | None],
    ) -> None:
        """Answers a query, and events on it.

        Args:
            give: Returns the fields of the present report; None when there is none now.
        """
        made = message_class(report)

        def provided(_query: EntryMessage, _sender: JausAddress) -> EntryMessage | None:
            fields = give()
            if fields is None:
                return None
            if not isinstance(fields, dict):
                raise TypeError(f"the answer to {query.name} is {fields!r}, not a dict of fields")
            return made(report.completed(fields))

        self._component.provide(message_class(query), made, provided)

    def report_changed(self, report: MessageEntry) -> None:
        """Sends a report to who wants it at every change."""
        self._component.report_changed(message_class(report))

    def obey(
        self,
        entry: MessageEntry,
        take: Callable[[MessageEntry, dict[str, Any], JausAddress], None],
    ) -> None:
        """Has a function take a message; commands come from the controller in Ready alone.

        Args:
            take: Takes the message, its fields and its sender, on another thread.

        Raises:
            ValueError: Something takes it already.
        """
        self._component.handle(
            message_class(entry),
            lambda message, sender: take(entry, message.fields, sender),
            when=Guard.READY if entry.is_command else Guard.ANY,
        )

    def controls(self, target: JausAddress) -> bool:
        """Whether we hold control of a component."""
        return target in self._holds and self._holds[target].is_held

    def check_obeyed(self, target: JausAddress) -> None:
        """Refuses to go on when a component that we control obeys us no more."""
        hold = self._holds.get(target)
        if hold is not None and not hold.is_obeyed:
            raise Refused(f"{target} {hold.last_change or 'does not obey us'}")

    @property
    def holds(self) -> tuple[Hold, ...]:
        """The components whose control was given to us, whatever became of it since."""
        return tuple(self._holds.values())

    def release(self, target: JausAddress) -> bool:
        """Releases control and returns whether the component says so."""
        while not self._rejections.empty():
            self._rejections.get_nowait()
        if not self._forget(target):
            return False
        end = time.monotonic() + self.timeout
        try:
            while self._rejections.get(timeout=max(0.0, end - time.monotonic())) != target:
                continue
        except Empty:
            return False
        return True

    def _forget(self, target: JausAddress) -> bool:
        hold = self._holds.pop(target, None)
        if hold is not None and hold.session is not None:
            hold.session.release()
        return hold is not None

    def _rejected(self, _message: RejectControl, sender: JausAddress) -> None:
        self._rejections.put(sender)
        if sender in self._holds:
            self._holds[sender].rejected()

    def _status_reported(self, report: ReportStatus, sender: JausAddress) -> None:
        if sender in self._holds:
            self._holds[sender].status_reported(report)

    def _why_refused(self, target: JausAddress) -> str:
        try:
            state, control = self.status(target)
        except NoAnswer:
            return "it does not say why"
        if state in (Status.INITIALIZE, Status.SHUTDOWN, Status.FAILURE, Status.EMERGENCY):
            return f"it is in {state.name}"
        if control is not None and control.subsystem_id:
            return (
                f"{control.subsystem_id}.{control.node_id}.{control.component_id} controls it "
                f"with authority {control.authority_code}; a higher authority preempts"
            )
        return "the authority is below its default; try a higher authority"


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
        identity: What we say of ourselves; that of an operator control unit when None.
        prepare: Makes the operator answer and obey, before anybody can ask it.

    Raises:
        OSError: The network cannot be used as the settings say.
    """
    ours = identity or Identity()
    with running_transport(network.settings) as transport:
        heard = Heard(catalogue, network, transport.counters)
        component = _Listening(
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


class _Listening(JausComponent):
    """A component that notes all that comes, also what no service of it takes."""

    def __init__(self, heard: Heard, transport: Transport, *arguments: Any, **others: Any) -> None:
        self._heard = heard
        super().__init__(transport, *arguments, **others)

    def _jaus_dispatcher(self) -> Take:
        take, note = super()._jaus_dispatcher(), self._heard.note

        def noting(payload: bytes, sender: JausAddress) -> None:
            note(payload, sender)
            take(payload, sender)

        return noting
