"""Clients of an operator beside queries: events, lists of components, and answers of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from queue import Empty, SimpleQueue
from typing import Any

from jausml.live.messages import MessageEntry
from jausml.live.peers.discovery import awaited
from jausml.live.peers.entry_messages import EntryMessage, full_query, message_class
from jausml.live.peers.query_client import M, NoAnswer, QueryClient, Refused
from jausml.live.peers.rendering import printable
from jausml.runtime import EventSubscription, ListElement, ListRequest, chain
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import (
    QueryElementCount,
    QueryElementList,
    RejectElementRequest,
    ReportElementCount,
    SetElement,
)
from jausml.runtime.services.definitions import Guard
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message

Reply = tuple[str, dict[str, Any]]  # name and fields of a message

_LATE_REPORTS = 3  # missing periodic reports after which silence is counted
_JAUS_MESSAGE = 0  # format of an element that is a message (AS5710, SetElement)
_LONGEST = 5.0  # seconds that one request may take, with its repetitions


class WatchingClient(QueryClient):
    """Client that subscribes to reports."""

    def watch(
        self,
        target: JausAddress,
        name: str,
        rate: float | None,
        on_report: Callable[[MessageEntry, dict[str, Any]], None],
        fields: dict[str, Any] | None = None,
    ) -> EventSubscription:
        """Subscribes to a report by an event, and waits for its confirmation.

        Missing periodic reports are counted and logged.

        Args:
            rate: Reports each second; None means every change.
            fields: Fields of the query; None requests all fields of the report.

        Raises:
            NoAnswer: The component does not answer.
            Refused: It refuses the event.
        """
        query, report = self.exchange(target, name)
        asked = full_query(query, report) if fields is None else fields
        patience = max(self.timeout, _LATE_REPORTS / rate) if rate and rate > 0 else 0.0
        silence = f"no {report.name} of {target} for {patience:g} s"
        subscription = self._component.subscribe(
            target,
            self.message(query, asked),
            message_class(report),
            lambda message, _: on_report(report, message.fields),
            rate=rate,
            silence_timeout=patience,
            on_silence=lambda: self._component.counters.count("event_client.silent", silence),
        )
        return self._confirmed(target, subscription, report)

    def follow(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[M],
        take: Callable[[M, JausAddress], None],
    ) -> EventSubscription:
        """Subscribes to a report at every change, without waiting."""
        return self._component.subscribe(target, query, report_class, take)

    def watch_encoded(
        self,
        target: JausAddress,
        exchange: tuple[MessageEntry, MessageEntry],
        rate: float | None,
        on_report: Callable[[bytes], None],
    ) -> EventSubscription:
        """Subscribes to a report like `watch`; `on_report` gets the payloads."""
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

    def deliver(
        self, target: JausAddress, message: Message, arrived: Callable[[bool], None]
    ) -> None:
        """Sends a stop before all waiting messages; `arrived` gets whether it was acknowledged.

        Earlier messages with its code are no longer repeated.
        """
        self._component.transport.send(
            self.own,
            target,
            message.encode(),
            priority=Priority.SAFETY_CRITICAL,
            acknowledge=True,
            on_result=arrived,
            supersedes=True,
        )

    def _confirmed(
        self, target: JausAddress, subscription: EventSubscription, report: MessageEntry
    ) -> EventSubscription:
        """Waits until the event of a subscription is confirmed, and returns the subscription."""
        if awaited(lambda: subscription.active or subscription.refusal, self.timeout) is True:
            return subscription
        refusal = subscription.refusal
        subscription.cancel()
        if refusal:
            raise Refused(f"{target} refuses events of {report.name}: {printable(refusal)}")
        raise self.unanswered(target, "CreateEvent")


class AnsweringClient(QueryClient):
    """Client whose component answers queries and takes commands."""

    def provide(
        self, query: MessageEntry, report: MessageEntry, give: Callable[[], dict[str, Any] | None]
    ) -> None:
        """Answers a query and its events.

        Args:
            give: Returns the fields of the present report; None when there is none.
        """
        report_class = message_class(report)

        def provided(_query: EntryMessage, _sender: JausAddress) -> EntryMessage | None:
            fields = give()
            if fields is None:
                return None
            if not isinstance(fields, dict):
                raise TypeError(f"the answer to {query.name} is {fields!r}, not a dict of fields")
            return report_class(report.completed(fields))

        self._component.provide(message_class(query), report_class, provided)

    def report_changed(self, report: MessageEntry) -> None:
        """Sends a report to subscribers of every change."""
        self._component.report_changed(message_class(report))

    def obey(
        self,
        entry: MessageEntry,
        take: Callable[[MessageEntry, dict[str, Any], JausAddress], Reply | None],
    ) -> None:
        """Calls `take` for each message; commands only from the controller, and in Ready.

        `take` returns a reply to the sender, or None.
        """

        def taken(message: EntryMessage, sender: JausAddress) -> None:
            reply = take(entry, message.fields, sender)
            if reply is not None:
                name, fields = reply
                self._component.send(self.message(self.find(self.own, name), fields), sender)

        self._component.handle(
            message_class(entry), taken, when=Guard.READY if entry.is_command else Guard.ANY
        )


class ListingClient(QueryClient):
    """Client that changes lists of controlled components, of each one list at a time."""

    def __init__(self, *others: Any) -> None:
        super().__init__(*others)
        self._changes: dict[JausAddress, tuple[ListRequest, SimpleQueue[str]]] = {}

    def set_list(
        self,
        target: JausAddress,
        payloads: Sequence[bytes],
        gate: AbstractContextManager[None] | None = None,
    ) -> None:
        """Replaces the list of a component by encoded messages, whose UIDs count from 1.

        Args:
            gate: Is held while the change begins, and may refuse it.

        Raises:
            NoAnswer: It does not confirm; the list may be set in part.
            Refused: It rejects an element, or the change was dropped.
        """
        ends: SimpleQueue[str] = SimpleQueue()
        unanswered = "no answer"
        with gate or nullcontext(), self._component.loop.lock:
            if target in self._changes:
                raise Refused(f"the list of {target} is being changed")
            request = self._component.set_list(
                target,
                _elements(payloads),
                on_done=lambda: ends.put(""),
                on_refused=lambda code: ends.put(unanswered if code is None else _reason(code)),
            )
            self._changes[target] = request, ends
        try:
            reason = ends.get(timeout=_LONGEST * (1 + len(payloads)))
        except Empty:  # our component has ended
            reason = unanswered
        finally:
            self._changes.pop(target, None)
            request.cancel()
        if reason == unanswered:
            raise self.unanswered(target, SetElement.NAME, "ConfirmElementRequest")
        if reason:
            raise Refused(f"{target} does not take the list: {reason}")

    def drop_list_changes(self) -> None:
        """Ends all changes of lists that are under way."""
        with self._component.loop.lock:  # `set_list` has noted each change that it began
            changes = tuple(self._changes.values())
        for request, ends in changes:
            request.cancel()
            ends.put("it was stopped meanwhile")

    def has_list(self, target: JausAddress, payloads: Sequence[bytes]) -> bool:
        """Returns whether a component has the list that `set_list` makes of encoded messages."""
        wanted = _elements(payloads)
        count = self.ask(target, QueryElementCount(), ReportElementCount).element_count
        if count != len(wanted):
            return False
        queue: SimpleQueue[tuple[ListElement, ...] | None] = SimpleQueue()
        self._component.read_list(target, queue.put, on_failure=lambda: queue.put(None))
        try:
            elements = queue.get(timeout=self.timeout * (1 + len(wanted)))
        except Empty:
            elements = None
        if elements is None:
            raise NoAnswer(
                f"{target} does not tell its list, which {QueryElementList.NAME} asks for"
            )
        return list(elements) == wanted


def _elements(payloads: Sequence[bytes]) -> list[ListElement]:
    return chain((uid, payload, _JAUS_MESSAGE) for uid, payload in enumerate(payloads, 1))


def _reason(code: int) -> str:
    known = RejectElementRequest.ResponseCode
    name = known(code).name if code in tuple(known) else "of no known meaning"
    return f"{RejectElementRequest.NAME} {code}, {name.lower().replace('_', ' ')}"
