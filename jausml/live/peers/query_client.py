"""Client of queries to components, whose errors explain a missing answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from queue import SimpleQueue
from typing import Any, TypeVar

from jausml.live.messages import AmbiguousMessageError, Catalogue, MessageEntry, MessageError
from jausml.live.peers.discovery import Survey, awaited, controller_of
from jausml.live.peers.entry_messages import find_exchange, find_message, full_query, message_class
from jausml.live.peers.heard import Heard, OpenQuery, start_query
from jausml.live.peers.network import Network
from jausml.runtime import JausComponent
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.quirks import Learnt
from jausml.runtime.messages import (
    QueryControl,
    QueryStatus,
    QueryTimeout,
    ReportControl,
    ReportStatus,
    ReportTimeout,
)
from jausml.runtime.services.definitions import ServiceIdentity, Status
from jausml.runtime.transports.transport import Transport
from jausml.runtime.wire.message import EncodeError, Message

M = TypeVar("M", bound="Message")

_GRACE = 0.5  # seconds to wait for a second report after the first of two
_SHORT_GRACE = 0.1  # the same for a component that did not send the second report before
_MEETINGS = 3  # queries with acknowledgement, of which some may be lost
_LAST_LOOK = 1.0  # seconds to wait for the reports that nearly all components send


class NoAnswer(Exception):  # noqa: N818 - an outcome of the network, not a fault of ours
    """A component does not answer; the text has the likely reason."""


class Refused(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """A component, or a check before sending, refuses a request; the text says why."""


class QueryClient:
    """Sends queries for one of our components, and waits for reports.

    Attributes:
        catalogue: The known messages.
        timeout: Seconds that a query waits for its report by default.
        survey: The components and services that were found.
    """

    def __init__(
        self,
        component: JausComponent,
        network: Network,
        catalogue: Catalogue,
        heard: Heard,
        timeout: float,
    ) -> None:
        self.catalogue = catalogue
        self.timeout = timeout
        self.survey = Survey(component, tuple(network.settings.address_book))
        self._component = component
        self._heard = heard
        self._half_silent: set[JausAddress] = set()

    def lives(self) -> dict[JausAddress, int]:
        """Returns how often each peer restarted its sequence numbers, as a new process does."""
        component = self._component
        peers = component.transport.traffic(component.address)
        return {peer.peer: peer.account.restarts for peer in peers}

    @property
    def transport(self) -> Transport:
        """The transport of our component."""
        return self._component.transport

    def learn(self, catalogue: Catalogue) -> None:
        """Replaces the catalogue."""
        self.catalogue = self._heard.catalogue = catalogue

    @property
    def own(self) -> JausAddress:
        """Our JAUS id."""
        return self._component.address

    @property
    def is_on_its_thread(self) -> bool:
        """Whether the caller is on the thread that takes the answers, which must not wait."""
        return self._component.loop.runs_here()

    @property
    def is_impersonated(self) -> bool:
        """Whether another program sends under our id."""
        return "transport.own_source" in self._component.counters.drops()

    def quirks(self) -> tuple[tuple[JausAddress, Learnt], ...]:
        """Returns the quirks of peers that have sent messages, in the order of their ids."""
        known = self._component.transport.quirks
        with self._component.loop.lock:
            return tuple(
                (peer, quirk) for peer in sorted(self.senders()) for quirk in known.of(peer)
            )

    def meet(self, target: JausAddress) -> tuple[ServiceIdentity, ...]:
        """Queries services and state of a component as bridges do, to learn its quirks.

        Its state is queried with acknowledgement, which does no harm and shows how it
        acknowledges. Control is not requested, and no event created.
        """
        component, query = self._component, QueryStatus().encode()
        services = self.services(target)
        for _ in range(_MEETINGS):
            ends: SimpleQueue[bool] = SimpleQueue()
            component.transport.send(
                component.address, target, query, acknowledge=True, on_result=ends.put
            )
            if self._begin(target, QueryStatus(), ReportStatus).within(self.timeout) is not None:
                component.transport.answered(component.address, target, query)
            ends.get()
        if target not in self.senders():
            raise self.unanswered(target, "QueryStatus", "ReportStatus")
        return services

    @property
    def nothing_heard(self) -> str:
        """The possible causes when no component answers, in words."""
        return f"nobody answers; {self._heard.nothing()}"

    def ask(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[Message],
        timeout: float | None = None,
    ) -> Any:
        """Returns the report that answers a query (`NoAnswer`: none comes in time)."""
        report = self._begin(target, query, report_class, timeout).within(None)
        if report is None:
            raise self.unanswered(target, query.NAME, report_class.NAME)
        return report

    def unanswered(self, target: JausAddress, message: str, report: str = "") -> NoAnswer:
        """Returns the error for a message without an answer, with the likely reason.

        A component that has sent nothing is first queried for the usual reports.
        """
        services: tuple[ServiceIdentity, ...] = self.survey.services(target)
        if not services or not self._heard.of(target):
            for question in (QueryStatus(), QueryControl()):
                self._component.send(question, target)
            self.survey.ask(target)
            seconds = min(self.timeout, _LAST_LOOK)
            services = awaited(lambda: self.survey.services(target), seconds)
        return NoAnswer(self._heard.why(target, message, report, services))

    def lack(self, target: JausAddress, message: str) -> str:
        """Returns, in words, that no known service of a component takes a message; else empty."""
        return self._heard.lack(message, self.survey.services(target))

    def _begin(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[Message],
        timeout: float | None = None,
    ) -> OpenQuery:
        """Sends a query without waiting for the report."""
        seconds = self.timeout if timeout is None else timeout
        return start_query(self._component, target, query, report_class, seconds)

    def first_answered(
        self, target: JausAddress, questions: Sequence[tuple[Message, type[Message]]]
    ) -> int | None:
        """Sends several queries at once and returns the index of the first that is answered.

        After one answer it waits only briefly for those of earlier queries.
        """
        queries = [self._begin(target, *question) for question in questions]
        awaited(lambda: any(query.is_over for query in queries))
        indices = (
            index for index, query in enumerate(queries) if query.within(_SHORT_GRACE) is not None
        )
        first = next(indices, None)
        for query in queries:
            query.cancel()
        return first

    def round_trip(
        self, target: JausAddress, query: Message, report_class: type[Message]
    ) -> float | None:
        """Sends a query once and returns the seconds until the report; None without one.

        JAUS queries have no number: a report that comes too late counts for the next query.
        """
        ends: SimpleQueue[float | None] = SimpleQueue()
        begin = time.perf_counter()
        pending = self._component.query(
            target,
            query,
            report_class,
            lambda _report, _sender: ends.put(time.perf_counter()),
            on_failure=lambda: ends.put(None),
            timeout=self.timeout,
            retries=0,
            payloads=True,
        )
        try:
            end = ends.get()
        finally:
            pending.cancel()
        return None if end is None else end - begin

    def ask_once(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[M],
        take: Callable[[M | None], None],
    ) -> None:
        """Sends a query once, without waiting; `take` gets the report, or None."""
        self._component.query(
            target,
            query,
            report_class,
            lambda report, _: take(report),
            on_failure=lambda: take(None),
            timeout=self.timeout,
            retries=0,
        )

    def on_report(self, report_class: type[M], take: Callable[[M, JausAddress], None]) -> None:
        """Calls `take` for each report of a class, requested or not, with its sender."""
        self._component.on_message(report_class, take)

    def senders(self) -> tuple[JausAddress, ...]:
        """Returns the components from which messages came."""
        return self._heard.sources()

    def services(self, target: JausAddress) -> tuple[ServiceIdentity, ...]:
        """Returns the services of a component, by its own Discovery or that of its subsystem."""
        return self.survey.services_within(self.timeout, target)

    def status(self, target: JausAddress) -> tuple[Status | None, ReportControl | None]:
        """Returns the Management state and the controller of a component, None where unknown.

        Both are queried at once; after one report it waits for the other one only briefly.
        """
        states = self._begin(target, QueryStatus(), ReportStatus)
        controls = self._begin(target, QueryControl(), ReportControl)
        awaited(lambda: states.is_over or controls.is_over)
        grace = _GRACE if target not in self._half_silent else _SHORT_GRACE
        state, control = states.within(grace), controls.within(grace)
        if state is None and control is None:
            raise self.unanswered(target, "QueryStatus", "ReportStatus")
        if state is None or control is None:
            self._half_silent.add(target)
        return None if state is None else status_of(state), control

    def control_timeout(self, target: JausAddress) -> int | None:
        """Returns the seconds after which control lapses; 0 for never, None if unknown.

        A component without AccessControl does not answer.
        """
        answer = self._begin(target, QueryTimeout(), ReportTimeout).within(_GRACE)
        return None if answer is None else int(answer.timeout)

    def look(self, target: JausAddress, tell: Callable[[str], None]) -> None:
        """Queries state and controller without waiting; `tell` gets each in words."""
        looks: tuple[tuple[Message, type[Message]], ...] = (
            (QueryStatus(), ReportStatus),
            (QueryControl(), ReportControl),
        )
        for query, report in looks:
            self._component.query(
                target,
                query,
                report,
                lambda answer, _: tell(_described(answer)),
                on_failure=partial(tell, f"does not answer {query.NAME}"),
                timeout=_GRACE,
                retries=1,
            )

    def query(
        self,
        target: JausAddress,
        name: str,
        fields: dict[str, Any] | None = None,
        timeout: float | None = None,
    ) -> tuple[MessageEntry, dict[str, Any]]:
        """Queries a report by name and returns it with its fields (`NoAnswer`: none comes).

        Args:
            fields: Fields of the query; None requests all fields of the report.
        """
        query, report = self.exchange(target, name)
        message = self.message(query, full_query(query, report) if fields is None else fields)
        answer = self.ask(target, message, message_class(report), timeout)
        return report, answer.fields

    def exchange(self, target: JausAddress, name: str) -> tuple[MessageEntry, MessageEntry]:
        """Returns the query and the report of a name, by the services of a component."""
        try:
            return find_exchange(self.catalogue, name)
        except AmbiguousMessageError:
            return find_exchange(self.catalogue, name, self.services(target))

    @staticmethod
    def message(entry: MessageEntry, fields: dict[str, Any]) -> Message:
        """Returns a message that can be sent (`MessageError`: a field is wrong)."""
        message = message_class(entry)(entry.completed(fields))
        try:
            message.encode()
        except EncodeError as error:
            raise MessageError(str(error)) from error
        return message

    def find(self, target: JausAddress, name: str) -> MessageEntry:
        """Returns the message of a name, by the services of a component."""
        try:
            return find_message(self.catalogue, name)
        except AmbiguousMessageError:
            return find_message(self.catalogue, name, self.services(target))


def _described(report: Message) -> str:
    if isinstance(report, ReportControl):
        nobody = not report.subsystem_id
        return "is controlled by " + ("nobody" if nobody else controller_of(report))
    state = status_of(report) if isinstance(report, ReportStatus) else None
    return "is in " + (state.name if state is not None else "an unknown state")


def status_of(report: ReportStatus) -> Status | None:
    """Returns the reported state; None when the standard does not define it."""
    try:
        return Status(report.status)
    except ValueError:
        return None
