"""One-time queries: ask, wait for the report, ask again.

Of what waits for equally long the first is due first: one timer serves all.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import takewhile
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ..wire.message import DecodeError, Message

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Loop, Timer
    from ..services.host import Host

R = TypeVar("R", bound=Message)
T = TypeVar("T")


class Deadlines(Generic[T]):
    """Deadlines of what waits for answers, to be used while the lock of the loop is held.

    All that wait for the same time share one timer of the loop: what came later is due later, and
    a timer for each would be made and cancelled in vain.
    """

    def __init__(self, loop: Loop, on_due: Callable[[T], None]) -> None:
        self._loop = loop
        self._on_due = on_due
        self._due: dict[float, dict[T, float]] = {}  # by delay, in the order in which they are due
        self._timers: dict[float, Timer] = {}

    def add(self, item: T, delay: float) -> None:
        """Wait so many seconds for an answer; nothing may wait twice for the same time."""
        due = self._loop.now() + delay
        waiting = self._due.get(delay)
        if waiting is None:
            waiting = self._due[delay] = {}
            self._set_timer(delay, due)
        waiting[item] = due

    def discard(self, item: T, delay: float) -> None:
        """Wait no longer; no effect for what does not wait."""
        waiting = self._due.get(delay)
        if waiting is not None:
            waiting.pop(item, None)

    def clear(self) -> None:
        """Wait for nothing any more."""
        for timer in self._timers.values():
            timer.cancel()
        for waiting in self._due.values():
            waiting.clear()
        self._timers.clear()
        self._due.clear()

    def _set_timer(self, delay: float, due: float) -> None:
        self._timers[delay] = self._loop.call_at(due, partial(self._expire, delay))

    def _expire(self, delay: float) -> None:
        """Tell what is due; the next that will be has the timer then."""
        waiting, now = self._due.get(delay, {}), self._loop.now()
        late = list(takewhile(lambda item: waiting[item] <= now, waiting))
        try:
            for item in late:
                if waiting.pop(item, None) is not None:  # an earlier one may have ended its wait
                    self._on_due(item)
        finally:
            if waiting:
                self._set_timer(delay, next(iter(waiting.values())))
            else:
                self._due.pop(delay, None)


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

    def cancel(self) -> None:
        """Wait no longer; neither callback is called."""
        with self._client.component.loop.lock:
            self._client.forget(self)


class QueryClient:
    """The one-time queries of one component; answers resolve them in the order of asking."""

    def __init__(self, component: Host) -> None:
        self.component = component
        self._pending: dict[type[Message], list[PendingQuery]] = {}
        self._deadlines: Deadlines[PendingQuery] = Deadlines(component.loop, self._send)
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
        """Send a query as soon as the component runs; see ``Querier.query``."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        queries = self._pending.get(report_class)
        if queries is None:
            queries = self._pending[report_class] = []
            self.component.on_payload(
                report_class, partial(self._reported, queries), is_robust=True
            )
        payload = query.encode()
        pending = PendingQuery(
            self,
            target,
            report_class,
            payload,
            on_report,
            payloads,
            on_failure,
            timeout,
            retries + 1,
        )
        queries.append(pending)
        if self.component.running:
            self._send(pending)
        else:
            self.component.when_started(partial(self._start, pending))
        return pending

    def forget(self, pending: PendingQuery) -> None:
        """Drop a query that is given up or cancelled; no effect when it does not wait."""
        queries = self._pending[pending.report_class]
        if pending in queries:
            queries.remove(pending)
            self._deadlines.discard(pending, pending.timeout)

    def stop(self) -> None:
        """Cancel all queries."""
        for queries in self._pending.values():
            for pending in list(queries):
                self.forget(pending)
        self._deadlines.clear()

    def _start(self, pending: PendingQuery) -> None:
        """Send a query at the start of the component, unless it was cancelled before."""
        if pending in self._pending[pending.report_class]:
            self._send(pending)

    def _send(self, pending: PendingQuery) -> None:
        """Send a query, or give up after the last attempt."""
        component = self.component
        if pending.attempts <= 0:
            self.forget(pending)
            component.counters.add("query_client.unanswered")
            if pending.on_failure is not None:
                component.call(pending.on_failure)
            return
        pending.attempts -= 1
        self._deadlines.add(pending, pending.timeout)
        component.transport.send(component.address, pending.target, pending.payload)

    def _reported(self, queries: list[PendingQuery], payload: bytes, sender: JausAddress) -> None:
        """Give a report to the first query that waits for one of its sender."""
        for pending in queries:
            if pending.target == sender:
                self._answered(pending, queries, payload, sender)
                return

    def _answered(
        self,
        pending: PendingQuery,
        queries: list[PendingQuery],
        payload: bytes,
        sender: JausAddress,
    ) -> None:
        """Hand over a report; the query goes on waiting if it is none."""
        report_class = pending.report_class
        try:
            report = payload if pending.takes_payloads else report_class.decode(payload)
        except DecodeError as error:
            self._count_bad(report_class, sender, error)
            return
        queries.remove(pending)
        self._deadlines.discard(pending, pending.timeout)
        if pending.takes_payloads:
            on_bad = partial(self._count_bad, report_class)
            self.component.payload_caller(pending.on_report, on_bad)(payload, sender)
        else:
            self.component.call(pending.on_report, report, sender)

    def _count_bad(
        self, report_class: type[Message], sender: JausAddress, error: DecodeError
    ) -> None:
        self.component.counters.count(
            "component.bad_message", f"{report_class.NAME} of {sender}: {error}"
        )
