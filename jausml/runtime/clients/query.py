"""One-time queries, repeated until their report arrives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..services.host import Host
from ..wire.message import DecodeError, Message


@dataclass(slots=True, eq=False)
class PendingQuery:
    """A query that waits for its report; made by ``Querier.query``."""

    _client: QueryClient
    target: JausAddress
    report_class: type[Message]
    payload: bytes
    on_report: Callable[[Any, JausAddress], None]
    takes_payloads: bool
    on_failure: Callable[[], None] | None  # called when every attempt stayed unanswered
    timeout: float  # seconds to wait before the query is repeated
    attempts: int  # how often it may still be sent
    timer: Alarm

    def cancel(self) -> None:
        """Ends the query; neither callback is called."""
        with self._client.component.loop.lock:
            self._client.forget(self)


class QueryClient:
    """The one-time queries of one component; reports answer them in the order of their calls."""

    def __init__(self, component: Host) -> None:
        self.component = component
        self._pending: dict[type[Message], list[PendingQuery]] = {}
        component.when_stopped(self.stop)

    def ask(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[Message],
        on_report: Callable[[Any, JausAddress], None],
        *,
        on_failure: Callable[[], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
        payloads: bool = False,
    ) -> PendingQuery:
        """Sends a query as soon as the component runs; see ``Querier.query``."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        queries = self._pending.get(report_class)
        if queries is None:
            queries = self._pending[report_class] = []
            self.component.on_payload(
                report_class, partial(self._reported, queries), is_robust=True
            )
        pending = PendingQuery(
            self,
            target,
            report_class,
            query.encode(),
            on_report,
            payloads,
            on_failure,
            timeout,
            retries + 1,
            Alarm(self.component.loop),
        )
        queries.append(pending)
        self.component.when_started(partial(self._start, pending))
        return pending

    def forget(self, pending: PendingQuery) -> None:
        """Drops a query; no effect if it does not wait."""
        queries = self._pending[pending.report_class]
        if pending in queries:
            queries.remove(pending)
            pending.timer.cancel()

    def stop(self) -> None:
        """Cancels all queries."""
        for queries in self._pending.values():
            for pending in list(queries):
                self.forget(pending)

    def _start(self, pending: PendingQuery) -> None:
        """Sends a query when the component runs, unless it was cancelled before."""
        if pending in self._pending[pending.report_class]:
            self._send(pending)

    def _send(self, pending: PendingQuery) -> None:
        """Sends a query, or gives up after the last attempt."""
        component = self.component
        if pending.attempts <= 0:
            self.forget(pending)
            component.counters.add("query_client.unanswered")
            if pending.on_failure is not None:
                component.call(pending.on_failure)
            return
        pending.attempts -= 1
        component.transport.send(component.address, pending.target, pending.payload)
        pending.timer.set(pending.timeout, partial(self._send, pending))

    def _reported(self, queries: list[PendingQuery], payload: bytes, sender: JausAddress) -> None:
        """Gives a report to the first query that waits for one of its sender."""
        pending = next((query for query in queries if query.target == sender), None)
        if pending is None:
            return
        report_class = pending.report_class
        try:
            report = payload if pending.takes_payloads else report_class.decode(payload)
        except DecodeError as error:  # the query goes on waiting
            self._count_bad(report_class, sender, error)
            return
        queries.remove(pending)
        if pending.takes_payloads:
            on_bad = partial(self._count_bad, report_class)
            self.component.payload_caller(pending.on_report, on_bad)(payload, sender)
        else:
            self.component.call(pending.on_report, report, sender)
        # Last, to keep it out of the latency.
        pending.timer.cancel()

    def _count_bad(
        self, report_class: type[Message], sender: JausAddress, error: DecodeError
    ) -> None:
        self.component.counters.count(
            "component.bad_message", f"{report_class.NAME} of {sender}: {error}"
        )
