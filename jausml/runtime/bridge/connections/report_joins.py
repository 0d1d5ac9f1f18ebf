"""Joined reports: further JAUS reports whose latest one is at hand when the main one arrives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...clients.peer_search import PeerBinding
from ...services.definitions import Guard
from ..ends import parameters
from ..ends.by_sender import Taker
from .joins import Joined
from .requests import EventRequests, QueryRequests

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...base.address import JausAddress
    from ...wire.message import Message
    from ..ends.ends import Ends


@dataclass(frozen=True)
class ReportJoin:
    """What the model says about a joined report.

    Attributes:
        query: The query whose answer is the report; None takes reports that are sent unasked.
        rate: Reports each second that are asked for; None means one on every change.
        is_asked: Whether a query asks for each report, instead of an event.
        peers: JAUS components that send it; none means those of the connection.
        freshness: Seconds after which the latest report is stale.
        drop: Whether a main message is dropped when there is nothing fresh. Otherwise its
            translation is given None.
    """

    name: str
    message: type[Message]
    query: Message | None = None
    rate: float | None = None
    is_asked: bool = False
    peers: Sequence[JausAddress] = ()
    freshness: float = 1.0
    drop: bool = False


class JoinedReport(Joined):
    """The latest of the reports of whoever sends it."""

    def __init__(self, join: ReportJoin) -> None:
        super().__init__(join.name, freshness=join.freshness, drop=join.drop)
        self.join = join
        self._peers = PeerBinding(join.peers)

    def open(
        self,
        ends: Ends,
        connection: str,
        peers: PeerBinding,
        refuse: Callable[[bytes, Any], None],
    ) -> None:
        """Asks for the reports, or listens."""
        join, owner = self.join, f"{connection}.{self.name}"
        self.begin(ends, owner, join.message.decode)
        if join.peers:
            self._peers = parameters.peers(ends.ros, owner, self._peers)
        else:
            self._peers = PeerBinding(peers.search or peers.present)
        if join.query is None:
            senders = None if self._peers.is_anybody else self._peers
            ends.accept(join.message, Taker(self.keep, senders, refuse), Guard.ANY)
            self._peers.follow(ends.component.find_peers, _nothing, _nothing)
        elif join.is_asked and join.rate is not None:
            asked = QueryRequests(ends, join.query, join.message, self.keep, join.rate)
            asked.rate = ends.ros.parameter(parameters.rate(owner, join.rate), asked.set_rate)
            self._peers.follow(ends.component.find_peers, _nothing, _nothing)
            asked.start(self._peers)
        else:
            events = EventRequests(ends, join.query, join.message, self.keep, join.rate)
            if join.rate is not None:
                rate = parameters.rate(owner, join.rate)
                events.rate = ends.ros.parameter(rate, events.set_rate)
            self._peers.follow(ends.component.find_peers, events.begin, events.end)


def _nothing(_peer: JausAddress) -> None:
    """Nothing is to be done about a peer that is met or gone."""
