"""Connections that publish reports on ROS topics, which JAUS components send as events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Concatenate, TypeVar

from ...base.address import JausAddress
from ...clients.event_client import EventClient
from ...clients.event_subscription import EventSubscription
from ...wire.message import Message
from ..ends import parameters
from ..ends.ends import Ends
from ..ends.simulation import real_rate
from ..ends.topics import TopicFault
from ..reports.diagnostics import LOST_ON_THE_WAY, OUT_OF_ORDER
from .connection import Take
from .to_ros import ToTopics

SourceT = TypeVar("SourceT", bound="Message")
TargetT = TypeVar("TargetT")

UNASKED = "unasked"


class EventRequests:
    """Subscriptions to the AS5710 event of a report, one for each peer."""

    def __init__(
        self, ends: Ends, query: Message, message: type[Message], take: Take, rate: float | None
    ) -> None:
        self.rate = rate  # reports each second; None means one on every change
        self._ends = ends
        self._query = query
        self._message = message
        self._take = take
        self._events: dict[JausAddress, EventSubscription] = {}
        self._lost = self._late = 0
        # Peers run in real time, so their rate depends on the pace of simulated time.
        if rate is not None and ends.simulation is not None:
            ends.simulation.clock.follow_ratio(self._renew)

    def begin(self, peer: JausAddress) -> None:
        """Subscribes to the event of a peer."""
        self._events[peer] = self._ends.component.part(EventClient).subscribe(
            peer, self._query, self._message, self._take, rate=self._real_rate, payloads=True
        )

    def end(self, peer: JausAddress) -> None:
        """Cancels the event of a peer."""
        self._end(self._events.pop(peer))

    @property
    def lost(self) -> int:
        """Number of reports that did not arrive."""
        return self._lost + sum(event.lost for event in self._events.values())

    @property
    def late(self) -> int:
        """Number of reports that came after newer ones."""
        return self._late + sum(event.late for event in self._events.values())

    def set_rate(self, hertz: float) -> None:
        """Renews the events of all peers for another rate."""
        with self._ends.loop.lock:
            self.rate = hertz
            self._renew()

    def state_of(self, peer: JausAddress) -> str:
        """Returns the state of the event of a peer, for diagnostics."""
        event = self._events.get(peer)
        return "confirmed" if event is not None and event.active else "asked"

    def _renew(self) -> None:
        """Replaces the events of all peers by ones of the present rate."""
        if self._events:
            former, self._events = self._events, {}
            # The new event is asked for before the former one ends, so that reports go on.
            for peer, event in former.items():
                self.begin(peer)
                self._end(event)

    def _end(self, event: EventSubscription) -> None:
        self._lost, self._late = self._lost + event.lost, self._late + event.late
        event.cancel()

    @property
    def _real_rate(self) -> float | None:
        """The rate requested from peers, which run in real time, also in simulated time."""
        simulation = self._ends.simulation
        if simulation is None or self.rate is None:
            return self.rate
        return real_rate(self.rate, simulation.clock.ratio)


class EventToTopics(ToTopics[SourceT, TargetT]):
    """Receives a report as an AS5710 event and publishes it."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        query: Message,
        rate: float | None = None,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            query: The query that the report answers; it selects the fields.
            rate: Reports each second, 0 for the frequency of the bridge; None means one on every
                change.
        """
        super().__init__(name, translate, **options)
        self.rate = rate
        self._query = query
        self._events: EventRequests
        self._unasked_of: JausAddress | None = None

    @property
    def declared_rate(self) -> float:
        """Reports each second from all peers together."""
        return (self.rate or 0.0) * len(self.peers)

    def open(self, ends: Ends) -> None:
        """Makes the publishers, then subscribes to the event of each peer."""
        if self.rate is not None:
            # The frequency of the bridge, for 0, is known only now.
            rate = self.rate or ends.settings.frequency
            self.rate = ends.ros.parameter(parameters.RATE.of(rate, self.name), self._set_rate)
        super().open(ends)

    def begin(self, ends: Ends) -> None:
        """Prepares the subscriptions to the event."""
        self._events = EventRequests(ends, self._query, self._message, self._take, self.rate)
        ends.shared_messages.note_unasked(self._message, self._note_unasked, self._peers)

    def _note_unasked(self, _data: bytes, sender: JausAddress) -> None:
        """Counts a report that a peer sent without an event; its fields are not those asked for."""
        self._unasked_of = sender
        self.drop(UNASKED, self._unasked_text(sender))

    def _unasked_text(self, sender: JausAddress) -> str:
        sent = f"{sender} sends {self._message.NAME} unasked, and {self.name} asks for events"
        return f"{sent}; exchange: message takes what comes unasked"

    def topic_faults(self) -> Iterator[TopicFault]:
        """Yields faults of the topics, and that a peer sends reports without an event."""
        yield from super().topic_faults()
        if self._unasked_of is not None and self.statistics.last_arrival is None:
            yield TopicFault(UNASKED, self._unasked_text(self._unasked_of))

    @property
    def is_latched(self) -> bool:
        """Whether the latest report stays valid until the next one: where each change is sent."""
        return self.rate is None and not self.is_command

    def _set_rate(self, hertz: float) -> None:
        self.rate = hertz
        self._events.set_rate(hertz)

    def _join(self, peer: JausAddress) -> None:
        self._events.begin(peer)

    def _leave(self, peer: JausAddress) -> None:
        self._events.end(peer)

    def silent_peers(self) -> Iterable[JausAddress]:
        """Returns peers that do not confirm the event, or have ceased to send it."""
        return [peer for peer in self.peers if self._state_of(peer) == "asked"]

    def losses(self) -> dict[str, int]:
        """Returns how many reports were lost, came out of order, or had no subscriber."""
        return {
            LOST_ON_THE_WAY: self._events.lost,
            OUT_OF_ORDER: self._events.late,
            **super().losses(),
        }

    def _state_of(self, peer: JausAddress) -> str:
        return self._events.state_of(peer)
