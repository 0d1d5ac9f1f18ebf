"""Connections that publish reports on ROS topics, for which they query JAUS components."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Concatenate, TypeVar

from ...base.address import JausAddress
from ...clients.peer_binding import PeerBinding
from ...clients.query import QueryClient
from ...services.host import Host
from ...wire.message import Message
from ..ends import parameters
from ..ends.ends import Ends
from .connection import Take
from .to_ros import ToTopics

SourceT = TypeVar("SourceT", bound="Message")
TargetT = TypeVar("TargetT")


class QueryRequests:
    """Queries for a report, one in each period to each peer."""

    def __init__(
        self, ends: Ends, query: Message, message: type[Message], take: Take, rate: float
    ) -> None:
        self.rate = rate  # queries each second
        self._ends = ends
        self._query = query
        self._message = message
        self._take = take
        self._peers: PeerBinding
        self._component: Host
        self._next = 0.0
        self._unanswered: set[JausAddress] = set()
        self._silent: set[JausAddress] = set()

    def start(self, peers: PeerBinding) -> None:
        """Queries all present peers, from the next turn of the loop on."""
        self._peers = peers
        self._component = self._ends.component
        self._next = self._ends.clock.now()
        self._ends.loop.call_soon(self._ask)

    def set_rate(self, hertz: float) -> None:
        """Changes the rate from the next query on."""
        self.rate = hertz

    def is_silent(self, peer: JausAddress) -> bool:
        """Returns whether a peer did not answer the last query."""
        return peer in self._silent

    def _ask(self) -> None:
        if not self._component.running:
            return  # the bridge was closed; opened again, it makes new `QueryRequests`
        clock = self._ends.clock
        # Absolute times, so that the rate does not drift; a late loop does not catch up.
        self._next = max(self._next + 1 / self.rate, clock.now())
        clock.call_at(self._next, self._ask)
        for peer in self._peers.present:
            (self._silent.add if peer in self._unanswered else self._silent.discard)(peer)
            self._unanswered.discard(peer)
            # No retries: the next period asks again. A late answer counts as an answer.
            self._component.part(QueryClient).ask(
                peer,
                self._query,
                self._message,
                self._take,
                on_failure=partial(self._unanswered.add, peer),
                timeout=1 / self.rate,
                retries=0,
                payloads=True,
            )


class QueryToTopics(ToTopics[SourceT, TargetT]):
    """Asks for a report once each period and publishes the answer."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        query: Message,
        rate: float,
        **options: Any,
    ) -> None:
        """Prepares the connection; the rate is in queries each second, 0 for that of the bridge."""
        super().__init__(name, translate, **options)
        self.rate = rate
        self._query = query
        self._queries: QueryRequests

    @property
    def declared_rate(self) -> float:
        """Queries each second to all peers together."""
        return self.rate * len(self.peers)

    def open(self, ends: Ends) -> None:
        """Makes the publishers, then starts to query."""
        super().open(ends)
        rate = self.rate or ends.settings.frequency
        self._queries = QueryRequests(ends, self._query, self._message, self._take, rate)
        rate = ends.ros.parameter(parameters.RATE.of(rate, self.name), self._set_rate)
        self.rate = self._queries.rate = rate
        self._queries.start(self._peers)

    def _set_rate(self, hertz: float) -> None:
        self.rate = hertz
        self._queries.set_rate(hertz)

    def silent_peers(self) -> Iterable[JausAddress]:
        """Returns the peers that did not answer the last query."""
        return [peer for peer in self.peers if self._queries.is_silent(peer)]

    def _state_of(self, peer: JausAddress) -> str:
        return "asked" if self._queries.is_silent(peer) else "source"
