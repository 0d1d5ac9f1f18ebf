"""One-time queries: ask, wait for the report, ask again."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Timer
    from ..services.host import Host
    from ..wire.message import DecodeError, Message


class PendingQuery:
    """A query that waits for its report; made by ``JausComponent.query``.

    Attributes:
        target: The component that was asked.
        takes_payloads: Whether the encoded report is wanted.
    """

    def __init__(
        self,
        client: QueryClient,
        target: JausAddress,
        payload: bytes,
        on_report: Callable[[Any, JausAddress], None],
        on_failure: Callable[[], None] | None,
        timeout: float,
        attempts: int,
        *,
        takes_payloads: bool,
    ) -> None:
        """Use ``JausComponent.query`` instead."""
        self.target = target
        self.takes_payloads = takes_payloads
        self._client = client
        self._payload = payload
        component = client.component
        self._take: Callable[[Any, JausAddress], object] = (
            component.payload_caller(on_report, self._count_bad)
            if takes_payloads
            else partial(component.call, on_report)
        )
        self._on_failure = on_failure
        self._timeout = timeout
        self._attempts = attempts
        self._timer: Timer | None = None

    def cancel(self) -> None:
        """Wait no longer; neither callback is called."""
        with self._client.component.loop.lock:
            self._client.forget(self)
            self.stop_waiting()

    def ask(self) -> None:
        """Send the query, or give up after the last attempt."""
        component = self._client.component
        if self._attempts <= 0:
            self._client.forget(self)
            component.counters.add("query_client.unanswered")
            if self._on_failure is not None:
                component.call(self._on_failure)
            return
        self._attempts -= 1
        self._timer = component.loop.call_later(self._timeout, self.ask)
        component.transport.send(component.address, self.target, self._payload)

    def answered(self, report: Message | bytes, sender: JausAddress) -> None:
        """Hand over the report."""
        self.stop_waiting()
        self._take(report, sender)

    def _count_bad(self, sender: JausAddress, error: DecodeError) -> None:
        self._client.component.counters.count("component.bad_message", f"{sender}: {error}")

    def stop_waiting(self) -> None:
        """Send the query no more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


class QueryClient:
    """The one-time queries of one component; answers resolve them in the order of asking.

    Attributes:
        component: The component that asks.
    """

    def __init__(self, component: Host) -> None:
        """Start without queries."""
        self.component = component
        self._pending: dict[type[Message], list[PendingQuery]] = {}

    def ask(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[Message],
        on_report: Callable[[Any, JausAddress], None],
        on_failure: Callable[[], None] | None,
        timeout: float,
        retries: int,
        *,
        payloads: bool = False,
    ) -> PendingQuery:
        """Send a query as soon as the component runs."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        if report_class not in self._pending:
            self._pending[report_class] = []
            self.component.on_payload(report_class, partial(self._reported, report_class))
        pending = PendingQuery(
            self,
            target,
            query.encode(),
            on_report,
            on_failure,
            timeout,
            retries + 1,
            takes_payloads=payloads,
        )
        self._pending[report_class].append(pending)
        self.component.when_started(lambda: self._start(pending))
        return pending

    def forget(self, pending: PendingQuery) -> None:
        """Drop a query that is answered, given up or cancelled."""
        for queries in self._pending.values():
            if pending in queries:
                queries.remove(pending)

    def stop(self) -> None:
        """Cancel all queries."""
        for queries in self._pending.values():
            for pending in queries:
                pending.stop_waiting()
            queries.clear()

    def _start(self, pending: PendingQuery) -> None:
        if any(pending in queries for queries in self._pending.values()):
            pending.ask()

    def _reported(self, report_class: type[Message], payload: bytes, sender: JausAddress) -> None:
        queries = self._pending[report_class]
        for pending in queries:
            if pending.target == sender:
                report = payload if pending.takes_payloads else report_class.decode(payload)
                queries.remove(pending)
                pending.answered(report, sender)
                return
