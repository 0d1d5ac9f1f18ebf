"""One subscriber to an event of another component."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Timer
    from ..services.host import Host
    from ..wire.message import DecodeError, Message


class Stream(Protocol):
    """The event as its subscribers see it.

    Attributes:
        component: The component that subscribes.
        provider: The component that provides the report.
    """

    component: Host
    provider: JausAddress

    @property
    def active(self) -> bool:
        """Whether the provider has confirmed the event."""

    def leave(self, subscription: EventSubscription) -> None:
        """Remove a subscriber."""

    def count_bad(self, provider: JausAddress, error: DecodeError) -> None:
        """Count a report that cannot be read."""


class EventSubscription:
    """One subscriber's share in an event; made by ``JausComponent.subscribe``.

    Attributes:
        provider: The component that provides the report.
        rate: Reports each second that the subscriber asked for; None means every change.
        takes_payloads: Whether the subscriber takes encoded reports.
    """

    def __init__(
        self,
        stream: Stream,
        on_report: Callable[[Any, JausAddress], None],
        rate: float | None,
        silence_timeout: float,
        on_silence: Callable[[], None] | None,
        *,
        takes_payloads: bool = False,
    ) -> None:
        """Use ``JausComponent.subscribe`` instead."""
        self.provider = stream.provider
        self.rate = rate
        self.takes_payloads = takes_payloads
        self._stream = stream
        self._component = stream.component
        self._take: Callable[[Any, JausAddress], object] = (
            self._component.payload_caller(on_report, stream.count_bad)
            if takes_payloads
            else partial(self._component.call, on_report)
        )
        self._silence_timeout = silence_timeout
        self._on_silence = on_silence
        self._watch: Timer | None = None
        self._heard = 0.0
        self._silent = False

    @property
    def active(self) -> bool:
        """Whether the provider has confirmed the event."""
        return self._stream.active

    @property
    def silent(self) -> bool:
        """Whether no report came for the silence timeout."""
        return self._silent

    def cancel(self) -> None:
        """End the subscription; the event is cancelled with its last subscriber."""
        with self._component.loop.lock:
            self.stop_watching()
            self._stream.leave(self)

    def start_watching(self) -> None:
        """Begin to wait for the first report."""
        self._heard = self._component.loop.now()
        if self._silence_timeout > 0:
            self._watch_from(self._heard)

    def stop_watching(self) -> None:
        """Detect no silence any more."""
        if self._watch is not None:
            self._watch.cancel()
            self._watch = None

    def deliver(self, report: Message | bytes, now: float) -> None:
        """Hand a report to the subscriber."""
        self._heard = now
        if self._silent:
            self._silent = False
            self._watch_from(now)
        self._take(report, self.provider)

    def _watch_from(self, heard: float) -> None:
        loop = self._component.loop
        self._watch = loop.call_at(heard + self._silence_timeout, self._look)

    def _look(self) -> None:
        """Re-arm for the last report instead of re-arming at every report."""
        if self._component.loop.now() < self._heard + self._silence_timeout:
            self._watch_from(self._heard)
            return
        self._silent = True
        self._watch = None
        self._component.counters.add("event_client.silent")
        if self._on_silence is not None:
            self._component.call(self._on_silence)
