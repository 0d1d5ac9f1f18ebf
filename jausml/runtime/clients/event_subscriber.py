"""Components that subscribe to reports of other components."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from ..base.address import JausAddress
from ..services.host import Host
from ..wire.message import Message
from .event_client import EventClient
from .event_subscription import EventSubscription

R = TypeVar("R", bound=Message)


class EventSubscriber(Host):
    """A component that subscribes to reports of other components."""

    def subscribe(
        self,
        provider: JausAddress,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None] | Callable[[bytes, JausAddress], None],
        *,
        rate: float | None = None,
        silence_timeout: float = 0.0,
        on_silence: Callable[[], None] | None = None,
        stands_by: bool = False,
        payloads: bool = False,
    ) -> EventSubscription:
        """Subscribes to a report of another component over an AS5710 event.

        The event is created as soon as the provider answers, renewed, and created anew when the
        provider was restarted. Subscriptions of this component to the same provider and query
        share one event at their highest rate, or at every change if any of them wants that; those
        with a rate are served by queries then. A later subscriber gets the last report at once.

        Args:
            query: Asks for the report; its presence vector selects the fields.
            rate: Reports each second, above 0 and up to 1092; None means every change.
            silence_timeout: Seconds without a report before ``on_silence``; 0 means never.
            on_silence: Called once each time the provider falls silent.
            stands_by: Whether silence puts the component into Standby, before ``on_silence``.
            payloads: Whether ``on_report`` takes the encoded report, message code and body. It
                may raise DecodeError, which is counted.
        """
        if stands_by:
            on_silence = partial(self._jaus_stand_by, provider, on_silence)
        with self.loop.lock:
            return self.part(EventClient).subscribe(
                provider,
                query,
                report_class,
                on_report,
                rate=rate,
                silence_timeout=silence_timeout,
                on_silence=on_silence,
                payloads=payloads,
            )
