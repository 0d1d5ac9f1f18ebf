"""Subscribers to an event of another component."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.fast_path import FastPath, fast_path_of
from ..base.loop import Loop, Timer
from ..services.host import Host
from ..wire.message import DecodeError, Message


class QueryTimer:
    """Queries at a rate, for a subscriber with a rate to an event of every change.

    A provider has one event for each query of a client (AS5710, CreateEvent): a periodic one would
    replace that of every change. Queries are due at absolute times, so that their rate does not
    drift; a late loop skips some.
    """

    def __init__(self, loop: Loop, rate: float, ask: Callable[[float], object]) -> None:
        """Queries at once; `ask` takes the seconds until the next query."""
        self._loop = loop
        self._period = 1 / rate
        self._ask = ask
        self._next = loop.now()
        self._timer: Timer = loop.call_at(self._next, self._due)

    def stop(self) -> None:
        """Sends no more queries."""
        self._timer.cancel()

    def _due(self) -> None:
        self._next = max(self._next + self._period, self._loop.now())
        self._timer = self._loop.call_at(self._next, self._due)
        self._ask(self._period)


_LONG_AGO = float("-inf")
_SAME_RATE = 0.999  # ratio from which on two rates are the same: on the wire a rate has 16 bits


class Stream(Protocol):
    """The event as its subscribers see it."""

    component: Host
    provider: JausAddress
    missing: int
    late: int
    refusal: str

    @property
    def active(self) -> bool:
        """Whether the provider has confirmed the event."""

    def leave(self, subscription: EventSubscription) -> None:
        """Removes a subscriber."""

    def count_bad(self, provider: JausAddress, error: DecodeError) -> None:
        """Counts a report that cannot be decoded."""


class EventSubscription:
    """One subscriber of an event; made by ``JausComponent.subscribe``."""

    ask: Callable[[float], object]  # asks the provider for one report, which `answer` takes

    def __init__(
        self,
        stream: Stream,
        report_class: type[Message],
        on_report: Callable[[Any, JausAddress], None],
        # Reports each second that the subscriber asked for; None means every change.
        rate: float | None,
        silence_timeout: float,
        on_silence: Callable[[], None] | None,
        *,
        # Whether the subscriber takes encoded reports.
        takes_payloads: bool = False,
    ) -> None:
        self.provider = stream.provider
        self.report_class = report_class
        self.rate = rate
        self.takes_payloads = takes_payloads
        self._stream = stream
        self._missing_before, self._late_before = stream.missing, stream.late
        self._component = stream.component
        self._on_report = on_report
        self._hand_on: Callable[[Any, JausAddress], object] = (
            self._component.payload_caller(on_report, stream.count_bad)
            if takes_payloads
            else partial(self._component.call, on_report)
        )
        self._silence_timeout = silence_timeout
        self._on_silence = on_silence
        self._watch = Alarm(stream.component.loop)
        self._heard = 0.0
        self._silent = False
        self._query_timer: QueryTimer | None = None
        self._period = 0.0
        self._slack = 0.0
        self._due = _LONG_AGO

    @property
    def active(self) -> bool:
        """Whether the provider has confirmed the event."""
        return self._stream.active

    @property
    def refusal(self) -> str:
        """Error message and code of the provider's rejection; empty without one."""
        return self._stream.refusal

    @property
    def lost(self) -> int:
        """Reports of the event that did not arrive since the subscription began."""
        return self._stream.missing - self._missing_before

    @property
    def late(self) -> int:
        """Reports of the event that arrived after newer ones, since the subscription began."""
        return self._stream.late - self._late_before

    @property
    def silent(self) -> bool:
        """Whether no report came for the silence timeout."""
        return self._silent

    def cancel(self) -> None:
        """Ends the subscription; the event is cancelled with its last subscriber."""
        with self._component.loop.lock:
            self.stop_watching()
            self._stream.leave(self)

    def fast_path(self) -> FastPath | None:
        """Returns the fast path of the reports; None if the subscriber does not get each one."""
        if self._query_timer is not None or self._period or self._silent:
            return None
        return fast_path_of(self._on_report, self.provider)

    def note_heard(self, at: float) -> None:
        """Notes the loop time of a report that took the fast path."""
        self._heard = at

    def start_watching(self) -> None:
        """Begins to wait for the first report."""
        self._heard = self._component.loop.now()
        if self._silence_timeout > 0:
            self._watch_from(self._heard)

    def stop_watching(self) -> None:
        """Stops the detection of silence and the queries."""
        self._watch.cancel()
        self._stop_asking()

    def follow(self, event_rate: float | None) -> None:
        """Derives the own rate from that of the shared event, which is None at every change."""
        self._component.loop.revision.changed()
        is_slower = (
            self.rate is not None and event_rate is not None and self.rate < _SAME_RATE * event_rate
        )
        self._period = 1 / self.rate if is_slower and self.rate else 0.0
        self._slack = 0.5 / event_rate if event_rate else 0.0
        if self.rate is None or event_rate is not None:
            self._stop_asking()
        elif self._query_timer is None:
            self._component.when_started(self._start_asking)

    def _start_asking(self) -> None:
        if self._query_timer is None and self.rate is not None:
            self._component.loop.revision.changed()
            self._query_timer = QueryTimer(self._component.loop, self.rate, self.ask)

    def _stop_asking(self) -> None:
        if self._query_timer is not None:
            self._query_timer.stop()
            self._query_timer = None

    def read(self, payload: bytes) -> Message | bytes | None:
        """Returns a report, decoded unless the subscriber takes payloads; None if not decodable."""
        if self.takes_payloads and int.from_bytes(payload[:2], "little") == self.report_class.CODE:
            return payload
        try:
            return self.report_class.decode(payload)
        except DecodeError as error:
            self._stream.count_bad(self.provider, error)
            return None

    def deliver(self, report: Message | bytes, now: float) -> None:
        """Hands a report of the event to the subscriber, if due at its rate."""
        if self._query_timer is not None:
            return
        if self._period:
            if now < self._due - self._slack:
                return
            is_in_time = now < self._due + self._period
            self._due = (self._due if is_in_time else now) + self._period
        self._hand_over(report, now)

    def answer(self, report: Message | bytes, _provider: JausAddress) -> None:
        """Hands the answer to a query of the timer to the subscriber."""
        if self._query_timer is not None:
            self._hand_over(report, self._component.loop.now())

    def _hand_over(self, report: Message | bytes, now: float) -> None:
        self._heard = now
        if self._silent:
            self._silent = False
            self._watch_from(now)
        self._hand_on(report, self.provider)

    def _watch_from(self, heard: float) -> None:
        self._watch.set_at(heard + self._silence_timeout, self._check_silence)

    def _check_silence(self) -> None:
        # The alarm is set anew here, rather than at every report.
        if self._component.loop.now() < self._heard + self._silence_timeout:
            self._watch_from(self._heard)
            return
        self._silent = True
        self._component.loop.revision.changed()
        self._component.counters.add("event_client.silent")
        if self._on_silence is not None:
            self._component.call(self._on_silence)
