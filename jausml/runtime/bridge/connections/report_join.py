"""Reports of JAUS components that are joined with the message of a connection to ROS."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ...base.address import JausAddress
from ...clients.peer_binding import PeerBinding
from ...services.definitions import Guard
from ...wire.message import Message
from ..ends import parameters
from ..ends.ends import Ends, Taker
from .events_to_ros import EventRequests
from .joins import Latest
from .queries_to_ros import QueryRequests


class ReportJoin(Latest):
    """The latest report of any of the peers."""

    def __init__(
        self,
        name: str,
        message: type[Message],
        query: Message | None = None,
        *,
        rate: float | None = None,
        is_asked: bool = False,
        peers: Sequence[JausAddress] = (),
        freshness: float = 1.0,
        drop: bool = False,
    ) -> None:
        """Keeps no report yet; `freshness` and `drop` are those of `Latest`.

        Args:
            query: The query that the report answers; None takes reports that are sent unasked.
            rate: Reports each second that are asked for, 0 for the frequency of the bridge; None
                means one on every change.
            is_asked: Whether a query asks for each report, instead of an event for all.
            peers: JAUS components that send it; none means those of the connection.
        """
        super().__init__(name, freshness=freshness, drop=drop)
        self._message = message
        self._query = query
        self._rate = rate
        self._is_asked = is_asked
        self._own_peers = tuple(peers)

    def open(
        self, ends: Ends, connection: str, peers: PeerBinding, refuse: Callable[[bytes, Any], None]
    ) -> None:
        """Subscribes to the reports, starts to query for them, or waits for unasked ones.

        Args:
            connection: Name of the connection, for names of parameters.
            peers: Peers of the connection.
            refuse: Called with a report of any other sender.
        """
        owner, message = f"{connection}.{self.name}", self._message
        default_rate = self._rate or (None if self._rate is None else ends.settings.frequency)
        self.begin(ends, owner, message.decode)
        if self._own_peers:
            binding = parameters.peers(ends.ros, owner, PeerBinding(self._own_peers))
        else:
            binding = PeerBinding(peers.search or peers.present)
        if self._query is None:
            senders = None if binding.is_anybody else binding
            ends.shared_messages.accept(message, Taker(self.keep, senders, refuse), Guard.ANY)
            binding.follow(ends.component, _ignore, _ignore)
        elif self._is_asked and default_rate is not None:
            queries = QueryRequests(ends, self._query, message, self.keep, default_rate)
            queries.rate = ends.ros.parameter(
                parameters.RATE.of(default_rate, owner), queries.set_rate
            )
            binding.follow(ends.component, _ignore, _ignore)
            queries.start(binding)
        else:
            events = EventRequests(ends, self._query, message, self.keep, default_rate)
            if default_rate is not None:
                rate = parameters.RATE.of(default_rate, owner)
                events.rate = ends.ros.parameter(rate, events.set_rate)
            binding.follow(ends.component, events.begin, events.end)


def _ignore(_peer: JausAddress) -> None:
    """Does nothing about a peer that has come or gone."""
