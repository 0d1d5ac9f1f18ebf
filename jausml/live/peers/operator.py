"""Operator control unit: one JAUS component that asks, watches and commands others."""

from __future__ import annotations

import math
import time
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from jausml.live.messages import AmbiguousMessageError, MessageError
from jausml.live.peers.discovery import Survey
from jausml.live.peers.entry_messages import find_exchange, find_message, message_class
from jausml.live.peers.heard import Heard
from jausml.live.peers.samples import full_query
from jausml.runtime import ComponentSettings, ControlState, JausComponent, Scope
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import (
    QueryControl,
    QueryStatus,
    RejectControl,
    ReportControl,
    ReportStatus,
)
from jausml.runtime.services.definitions import CORE, ServiceIdentity, Status
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import EncodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jausml.live.messages import Catalogue, MessageEntry
    from jausml.live.peers.network import Network
    from jausml.runtime import ControlSession, EventSubscription
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.clients.query import PendingQuery
    from jausml.runtime.transports.delivery import ReceivedMessage
    from jausml.runtime.transports.transport import Transport
    from jausml.runtime.wire.message import Message

OCU_TYPE = 20001
"""Type of an operator control unit (AS5710, ReportIdentification)."""

ATTEMPTS = 3
"""Fewest times that a question is asked; of long times for an answer, once each second."""

_POLL = 0.01

_GRACE = 0.5
"""Seconds for the second of two questions, when the first is answered."""

_LAST_LOOK = 1.0
"""Seconds in which a silent component may answer what nearly all of them answer."""

_SERVICES = tuple(
    ServiceIdentity(CORE + name, 1, 1) for name in ("Transport", "Events", "Liveness", "Discovery")
)


class NoAnswer(Exception):  # noqa: N818 - an outcome of the network, not a fault of ours
    """A component does not answer."""


class Refused(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """A component answers, but not as wished."""


class Operator:
    """The actions of an operator; each call waits for its outcome.

    Attributes:
        catalogue: All messages that we know.
        survey: Who is there.
        timeout: Seconds to wait for an answer.
    """

    def __init__(
        self,
        component: JausComponent,
        network: Network,
        catalogue: Catalogue,
        heard: Heard,
        timeout: float,
    ) -> None:
        """Use `running_operator` instead."""
        self.catalogue = catalogue
        self.timeout = timeout
        self.survey = Survey(component, tuple(network.settings.address_book))
        self._component = component
        self._heard = heard
        self._half_silent: set[JausAddress] = set()
        self._sessions: dict[JausAddress, ControlSession] = {}
        self._rejections: SimpleQueue[JausAddress] = SimpleQueue()
        component.on_message(RejectControl, lambda _, sender: self._rejections.put(sender))

    @property
    def nothing_heard(self) -> str:
        """What may be the cause when nobody answers."""
        return f"nobody answers; {self._heard.nothing()}"

    # ---- asking -----------------------------------------------------------------------------

    def ask(self, target: JausAddress, query: Message, report_class: type[Message]) -> Any:
        """Returns the report that answers a query.

        Raises:
            NoAnswer: None comes.
            EncodeError: The query's fields are wrong.
        """
        report = self._begin(target, query, report_class).within(None)
        if report is None:
            raise self.unanswered(target, query.NAME, report_class.NAME)
        return report

    def unanswered(self, target: JausAddress, message: str, report: str = "") -> NoAnswer:
        """Returns the error of a message that stays unanswered, with what was heard.

        A component of which nothing was heard is asked what nearly all of them answer.

        Args:
            target: The component.
            message: Name of the message.
            report: Name of its answer, empty when there are several.
        """
        services: tuple[ServiceIdentity, ...] = self.survey.services(target)
        if not services or not self._heard.of(target):
            for question in (QueryStatus(), QueryControl()):
                self._component.send(question, target)
            self.survey.ask(target)
            end = time.monotonic() + min(self.timeout, _LAST_LOOK)
            while not services and time.monotonic() < end:
                time.sleep(_POLL)
                services = self.survey.services(target)
        return NoAnswer(self._heard.why(target, message, report, services))

    def _begin(self, target: JausAddress, query: Message, report_class: type[Message]) -> _Question:
        """Asks, without waiting for the answer."""
        attempts = max(ATTEMPTS, math.ceil(self.timeout))
        answers: SimpleQueue[Any] = SimpleQueue()
        pending = self._component.query(
            target,
            query,
            report_class,
            lambda report, _: answers.put(report),
            on_failure=lambda: answers.put(None),
            timeout=self.timeout / attempts,
            retries=attempts - 1,
        )
        return _Question(pending, answers)

    def services(self, target: JausAddress) -> tuple[ServiceIdentity, ...]:
        """Returns what a component, or the Discovery service of its subsystem, says it provides.

        Returns:
            The services; none when nobody knows.
        """
        known = self.survey.services(target)
        if not known:
            self.survey.ask(target)
            self.survey.ask(type(target)(target.subsystem, 255, 255))
            end = time.monotonic() + self.timeout
            while not known and time.monotonic() < end:
                time.sleep(_POLL)
                known = self.survey.services(target)
        return known

    def status(self, target: JausAddress) -> tuple[Status | None, ReportControl | None]:
        """Returns the Management state of a component and who controls it, None where unknown.

        Both are asked at once; after one answer the other one is not waited for as long.

        Raises:
            NoAnswer: It answers neither question.
        """
        states = self._begin(target, QueryStatus(), ReportStatus)
        controls = self._begin(target, QueryControl(), ReportControl)
        while not states.is_over and not controls.is_over:
            time.sleep(_POLL)
        grace = _GRACE if target not in self._half_silent else _POLL
        state, control = states.within(grace), controls.within(grace)
        if state is None and control is None:
            raise self.unanswered(target, "QueryStatus", "ReportStatus")
        if state is None or control is None:
            self._half_silent.add(target)
        return None if state is None else _status(state), control

    def query(
        self, target: JausAddress, name: str, fields: dict[str, Any] | None = None
    ) -> tuple[MessageEntry, dict[str, Any]]:
        """Asks for a report by name and returns it with its fields.

        Args:
            target: The component.
            name: Name or code of the query or of its report.
            fields: Fields of the query; the presence vector asks for everything if it is absent.

        Raises:
            MessageError: There is no such message, or the fields are wrong.
            NoAnswer: No report comes.
        """
        query, report = self.exchange(target, name)
        message = self.message(query, full_query(query, report) if fields is None else fields)
        answer = self.ask(target, message, message_class(report))
        return report, answer.fields

    def exchange(self, target: JausAddress, name: str) -> tuple[MessageEntry, MessageEntry]:
        """Returns the query and the report that a name means to a component.

        Raises:
            MessageError: There are none, or several.
        """
        try:
            return find_exchange(self.catalogue, name)
        except AmbiguousMessageError:
            return find_exchange(self.catalogue, name, self.services(target))

    @staticmethod
    def message(entry: MessageEntry, fields: dict[str, Any]) -> Message:
        """Returns a message, ready to be sent.

        Args:
            entry: The message.
            fields: Its fields; the one record of a body need not be named.

        Raises:
            MessageError: The fields are wrong.
        """
        message = message_class(entry)(completed(entry, fields))
        try:
            message.encode()
        except EncodeError as error:
            raise MessageError(str(error)) from error
        return message

    # ---- watching ---------------------------------------------------------------------------

    def watch(
        self,
        target: JausAddress,
        name: str,
        rate: float | None,
        on_report: Callable[[MessageEntry, dict[str, Any]], None],
    ) -> EventSubscription:
        """Subscribes to a report by an event.

        Args:
            target: The component.
            name: Name or code of the query or of its report.
            rate: Reports each second; None means every change.
            on_report: Takes the report and its fields, on another thread.

        Raises:
            MessageError: There is no such message.
            NoAnswer: The component does not confirm the event.
        """
        query, report = self.exchange(target, name)
        subscription = self._component.subscribe(
            target,
            self.message(query, full_query(query, report)),
            message_class(report),
            lambda message, _: on_report(report, message.fields),
            rate=rate,
        )
        end = time.monotonic() + self.timeout
        while not subscription.active:
            if time.monotonic() > end:
                subscription.cancel()
                raise self.unanswered(target, "CreateEvent")
            time.sleep(_POLL)
        return subscription

    # ---- control ----------------------------------------------------------------------------

    def control(self, target: JausAddress, authority: int) -> None:
        """Takes control and keeps it until `release`.

        Raises:
            NoAnswer: The component does not answer.
            Refused: It does not give control.
        """
        states: SimpleQueue[ControlState] = SimpleQueue()
        self._forget(target)
        session = self._component.control(
            target, authority=authority, resume=False, on_change=states.put
        )
        self._sessions[target] = session
        try:
            state = states.get(timeout=self.timeout)
        except Empty:
            self._forget(target)
            raise self.unanswered(target, "RequestControl", "ConfirmControl") from None
        if state is ControlState.REFUSED:
            self._forget(target)
            raise Refused(f"{target} gives no control: {self._why_refused(target)}")

    def change(self, target: JausAddress, message: Message, wanted: Status) -> Status | None:
        """Sends Resume or Standby and returns the state that follows; None without Management.

        Args:
            target: A component that we control.
            message: The command.
            wanted: The state that it leads to.

        Raises:
            Refused: The component does not come to the state.
        """
        try:
            state = _status(self.ask(target, QueryStatus(), ReportStatus))
        except NoAnswer:
            return None
        self._component.send(message, target)
        end = time.monotonic() + self.timeout
        while state is not wanted:
            if time.monotonic() > end:
                raise Refused(
                    f"{target} stays in {state.name if state is not None else 'an unknown state'} "
                    f"after {message.NAME}"
                )
            state = _status(self.ask(target, QueryStatus(), ReportStatus))
        return state

    def send(
        self, target: JausAddress, message: Message, priority: Priority = Priority.STANDARD
    ) -> None:
        """Sends a message, once and without waiting."""
        self._component.send(message, target, priority=priority)

    def find(self, target: JausAddress, name: str) -> MessageEntry:
        """Returns the message that a name means to a component.

        Raises:
            MessageError: There is none, or there are several.
        """
        try:
            return find_message(self.catalogue, name)
        except AmbiguousMessageError:
            return find_message(self.catalogue, name, self.services(target))

    def controls(self, target: JausAddress) -> bool:
        """Whether we hold control of a component."""
        session = self._sessions.get(target)
        held = (ControlState.CONTROLLED, ControlState.READY)
        return session is not None and session.state in held

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
        session = self._sessions.pop(target, None)
        if session is not None:
            session.release()
        return session is not None

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
                f"with authority {control.authority_code}; a higher --authority preempts"
            )
        return "the authority is below its default; try a higher --authority"


@contextmanager
def running_operator(
    network: Network, catalogue: Catalogue, timeout: float = 3.0
) -> Iterator[Operator]:
    """Yields an operator on the network; releases control and cancels events at the end.

    Args:
        network: Who we are, and how the others are reached.
        catalogue: All messages that we know.
        timeout: Seconds to wait for an answer.

    Raises:
        OSError: The network cannot be used as the settings say.
    """
    with running_transport(network.settings) as transport:
        heard = Heard(catalogue, network, transport.counters)
        component = _Listening(
            heard,
            transport,
            network.own,
            name="jausml ocu",
            services=_SERVICES,
            component_type=OCU_TYPE,
            settings=ComponentSettings(discovery_scope=Scope.SUBSYSTEM, register_services=False),
        )
        operator = Operator(component, network, catalogue, heard, timeout)
        component.start()
        try:
            yield operator
        finally:
            component.stop()


class _Listening(JausComponent):
    """A component that notes all that comes, also what no service of it takes."""

    def __init__(self, heard: Heard, transport: Transport, *arguments: Any, **others: Any) -> None:
        super().__init__(transport, *arguments, **others)
        self._heard = heard

    def _jaus_receive(self, received: ReceivedMessage) -> None:
        self._heard.note(received)
        super()._jaus_receive(received)


class _Question:
    """A question that waits for its answer."""

    def __init__(self, pending: PendingQuery, answers: SimpleQueue[Any]) -> None:
        self._pending = pending
        self._answers = answers

    @property
    def is_over(self) -> bool:
        """Whether the answer is there, or none came in time."""
        return not self._answers.empty()

    def within(self, seconds: float | None) -> Any:
        """Returns the answer, or None when none comes in time; then it is asked no more."""
        try:
            return self._answers.get(timeout=seconds)
        except Empty:
            self._pending.cancel()
            return None


def completed(entry: MessageEntry, fields: dict[str, Any]) -> dict[str, Any]:
    """Returns the fields of a message; the one record of a body need not be named.

    Args:
        entry: The message.
        fields: What the user gave.
    """
    members = entry.codec.members
    if len(members) != 1 or members[0].name in fields:
        return fields
    return {members[0].name: fields}


def _status(report: ReportStatus) -> Status | None:
    try:
        return Status(report.status)
    except ValueError:
        return None
