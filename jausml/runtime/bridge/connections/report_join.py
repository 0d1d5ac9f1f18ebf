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
    """The latest of the reports of whoever sends it."""

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
        """Keeps nothing yet.

        Args:
            query: The query whose answer is the report; None takes reports that are sent unasked.
            rate: Reports each second that are asked for, 0 for the frequency of the bridge; None
                means one on every change.
            is_asked: Whether a query asks for each report, instead of an event.
            peers: JAUS components that send it; none means those of the connection.
            freshness: Seconds after which the latest report is stale.
            drop: Whether a main message is dropped when there is nothing fresh. Otherwise its
                translation is given None.
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
        """Asks for the reports, or listens."""
        owner, message = f"{connection}.{self.name}", self._message
        usual = self._rate or (None if self._rate is None else ends.settings.frequency)
        self.begin(ends, owner, message.decode)
        if self._own_peers:
            met = parameters.peers(ends.ros, owner, PeerBinding(self._own_peers))
        else:
            met = PeerBinding(peers.search or peers.present)
        if self._query is None:
            senders = None if met.is_anybody else met
            ends.shared_messages.accept(message, Taker(self.keep, senders, refuse), Guard.ANY)
            met.follow(ends.component, _nothing, _nothing)
        elif self._is_asked and usual is not None:
            asked = QueryRequests(ends, self._query, message, self.keep, usual)
            asked.rate = ends.ros.parameter(parameters.RATE.of(usual, owner), asked.set_rate)
            met.follow(ends.component, _nothing, _nothing)
            asked.start(met)
        else:
            events = EventRequests(ends, self._query, message, self.keep, usual)
            if usual is not None:
                rate = parameters.RATE.of(usual, owner)
                events.rate = ends.ros.parameter(rate, events.set_rate)
            met.follow(ends.component, events.begin, events.end)


def _nothing(_peer: JausAddress) -> None:
    """Nothing is to be done about a peer that is met or gone."""
