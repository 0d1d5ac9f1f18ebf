"""How reports of JAUS components are asked for: as events, or by a query in each period."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ..ends.simulation import real_rate

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ...clients.event_subscription import EventSubscription
    from ...clients.peer_search import PeerBinding
    from ...component.component import JausComponent
    from ...wire.message import Message
    from ..ends.ends import Ends
    from .connection import Take


class EventRequests:
    """The AS5710 events of a report, one of each peer.

    Attributes:
        rate: Reports each second; None means one on every change.
    """

    def __init__(
        self, ends: Ends, query: Message, message: type[Message], take: Take, rate: float | None
    ) -> None:
        """Asks nobody yet.

        Args:
            message: The report.
        """
        self.rate = rate
        self._ends = ends
        self._query = query
        self._message = message
        self._take = take
        self._events: dict[JausAddress, EventSubscription] = {}
        self._lost = self._late = 0
        if rate is not None and ends.simulation is not None:
            ends.simulation.clock.follow_ratio(self._ask_anew)

    def begin(self, peer: JausAddress) -> None:
        """Asks a peer for the event."""
        self._events[peer] = self._ends.component.subscribe(
            peer, self._query, self._message, self._take, rate=self._real_rate, payloads=True
        )

    def end(self, peer: JausAddress) -> None:
        """Asks a peer no more."""
        self._end(self._events.pop(peer))

    @property
    def lost(self) -> int:
        """Reports that did not arrive."""
        return self._lost + sum(each.lost for each in self._events.values())

    @property
    def late(self) -> int:
        """Reports that came after newer ones."""
        return self._late + sum(each.late for each in self._events.values())

    def set_rate(self, hertz: float) -> None:
        """Has the events of all peers come at another rate."""
        with self._ends.loop.lock:
            self.rate = hertz
            self._ask_anew()

    def state_of(self, peer: JausAddress) -> str:
        """How it stands with a peer, for diagnostics."""
        event = self._events.get(peer)
        return "confirmed" if event is not None and event.active else "asked"

    def _ask_anew(self) -> None:
        """Has the events of all peers come at the present rate."""
        if self._events:
            former, self._events = self._events, {}
            for peer, event in former.items():
                self.begin(peer)
                self._end(event)

    def _end(self, event: EventSubscription) -> None:
        self._lost, self._late = self._lost + event.lost, self._late + event.late
        event.cancel()

    @property
    def _real_rate(self) -> float | None:
        """The rate that peers are asked for, whose clock is not that of a simulation."""
        simulation = self._ends.simulation
        if simulation is None or self.rate is None:
            return self.rate
        return real_rate(self.rate, simulation.clock.ratio)


class QueryRequests:
    """Queries for a report, one in each period to each peer.

    Attributes:
        rate: Queries each second.
    """

    def __init__(
        self, ends: Ends, query: Message, message: type[Message], take: Take, rate: float
    ) -> None:
        self.rate = rate
        self._ends = ends
        self._query = query
        self._message = message
        self._take = take
        self._peers: PeerBinding
        self._component: JausComponent
        self._next = 0.0
        self._unanswered: set[JausAddress] = set()
        self._silent: set[JausAddress] = set()

    def start(self, peers: PeerBinding) -> None:
        """Asks whoever is there, from the next turn of the loop on."""
        self._peers = peers
        self._component = self._ends.component
        self._next = self._ends.clock.now()
        self._ends.loop.call_soon(self._ask)

    def set_rate(self, hertz: float) -> None:
        """Asks at another rate from the next query on."""
        self.rate = hertz

    def is_silent(self, peer: JausAddress) -> bool:
        """Whether a peer did not answer lately."""
        return peer in self._silent

    def _ask(self) -> None:
        if not self._component.running:
            return  # the bridge was closed; opened again, it has other queries
        clock = self._ends.clock
        # Absolute times, so that the rate does not drift; a late loop does not catch up.
        self._next = max(self._next + 1 / self.rate, clock.now())
        clock.call_at(self._next, self._ask)
        for peer in self._peers.present:
            (self._silent.add if peer in self._unanswered else self._silent.discard)(peer)
            self._unanswered.discard(peer)
            # Repetition is the next period's; a late answer counts as an answer.
            self._component.query(
                peer,
                self._query,
                self._message,
                self._take,
                on_failure=partial(self._unanswered.add, peer),
                timeout=1 / self.rate,
                retries=0,
                payloads=True,
            )
