"""Reports of the peers that a search finds, by subscription or by query."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from ..base.address import JausAddress
from ..wire.message import Message
from .event_subscriber import EventSubscriber
from .event_subscription import EventSubscription
from .peer_binding import PeerBinding
from .peer_search import PeerSearch
from .querier import Querier

R = TypeVar("R", bound=Message)


class PeerSubscriber(EventSubscriber):
    """A component that subscribes to reports of the peers that it finds."""

    def subscribe_to_found(
        self,
        search: PeerSearch,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None],
        *,
        rate: float | None = None,
        silence_timeout: float = 0.0,
        on_silence: Callable[[JausAddress], None] | None = None,
        stands_by: bool = False,
    ) -> None:
        """Subscribes to a report of each peer that a search finds; see ``subscribe``.

        Args:
            rate: Reports each second of each provider; None means every change.
            silence_timeout: Seconds without a report before ``on_silence``; 0 means never.
            on_silence: Called with a provider each time that it falls silent.
            stands_by: Whether the component goes into Standby when a provider falls silent,
                before ``on_silence``, or is gone.
        """
        subscriptions: dict[JausAddress, EventSubscription] = {}

        def join(peer: JausAddress) -> None:
            subscriptions[peer] = self.subscribe(
                peer,
                query,
                report_class,
                on_report,
                rate=rate,
                silence_timeout=silence_timeout,
                on_silence=None if on_silence is None else partial(on_silence, peer),
                stands_by=stands_by,
            )

        def leave(peer: JausAddress) -> None:
            subscriptions.pop(peer).cancel()
            if stands_by:
                self._jaus_stand_by(peer, None)

        PeerBinding(search).follow(self, join, leave)


class PeerQuerier(Querier):
    """A component that queries the peers that it finds."""

    def query_found(
        self,
        search: PeerSearch,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None],
    ) -> None:
        """Queries each peer that a search finds for a report, once when it is found."""

        def join(peer: JausAddress) -> None:
            self.query(peer, query, report_class, on_report)

        PeerBinding(search).follow(self, join, lambda _peer: None)
