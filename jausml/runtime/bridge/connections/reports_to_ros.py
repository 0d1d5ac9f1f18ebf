"""Connections that ask JAUS components for reports, by events or queries, for ROS topics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from ..ends import parameters
from ..ends.topics import TopicFault
from ..reports.diagnostics import LOST_ON_THE_WAY, OUT_OF_ORDER
from .requests import EventRequests, QueryRequests
from .to_ros import ToTopics

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from typing import Concatenate

    from ...base.address import JausAddress
    from ...wire.message import Message
    from ..ends.ends import Ends

SourceT = TypeVar("SourceT", bound="Message")
TargetT = TypeVar("TargetT")

UNASKED = "unasked"


class EventToTopics(ToTopics[SourceT, TargetT]):
    """Receives a report as an AS5710 event and publishes it.

    Attributes:
        rate: Reports each second, 0 for the frequency of the bridge; None means one on every
            change.
    """

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
            query: The query whose answer is the report; it selects the fields.
        """
        super().__init__(name, translate, **options)
        self.rate = rate
        self._query = query
        self._events: EventRequests
        self._unasked_of: JausAddress | None = None

    @property
    def declared_rate(self) -> float:
        """The rate of the event, from all peers."""
        return (self.rate or 0.0) * len(self.peers)

    def open(self, ends: Ends) -> None:
        """Makes the publishers, then asks each peer for the event."""
        if self.rate is not None:
            # The frequency of the bridge, for 0, is known only now.
            rate = self.rate or ends.settings.frequency
            self.rate = ends.ros.parameter(parameters.RATE.of(rate, self.name), self._set_rate)
        super().open(ends)

    def begin(self, ends: Ends) -> None:
        """Prepares to ask for the event."""
        self._events = EventRequests(ends, self._query, self._message, self._take, self.rate)
        ends.shared_messages.note_unasked(self._message, self._note_unasked, self._peers)

    def _note_unasked(self, _data: bytes, sender: JausAddress) -> None:
        """Counts a report of a peer that is no event: which fields it has nobody has asked for."""
        self._unasked_of = sender
        self.drop(UNASKED, self._unasked_text(sender))

    def _unasked_text(self, sender: JausAddress) -> str:
        sent = f"{sender} sends {self._message.NAME} unasked, and {self.name} asks for events"
        return f"{sent}; exchange: message takes what comes unasked"

    def topic_faults(self) -> Iterator[TopicFault]:
        """What is wrong with the topics; also that a peer sends its reports in another way."""
        yield from super().topic_faults()
        if self._unasked_of is not None and self.statistics.last_arrival is None:
            yield TopicFault(UNASKED, self._unasked_text(self._unasked_of))

    @property
    def is_latched(self) -> bool:
        """Whether the latest report counts until there is another, as with every change."""
        return self.rate is None and not self.is_command

    def _set_rate(self, hertz: float) -> None:
        self.rate = hertz
        self._events.set_rate(hertz)

    def _join(self, peer: JausAddress) -> None:
        self._events.begin(peer)

    def _leave(self, peer: JausAddress) -> None:
        self._events.end(peer)

    def silent_peers(self) -> Iterable[JausAddress]:
        """Peers that do not confirm the event, or have ceased to send it."""
        return [peer for peer in self.peers if self._state_of(peer) == "asked"]

    def losses(self) -> dict[str, int]:
        """How many reports did not arrive, or too late, and how many nobody has heard."""
        return {
            LOST_ON_THE_WAY: self._events.lost,
            OUT_OF_ORDER: self._events.late,
            **super().losses(),
        }

    def _state_of(self, peer: JausAddress) -> str:
        return self._events.state_of(peer)


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
        super().__init__(name, translate, **options)
        self.rate = rate
        self._query = query
        self._queries: QueryRequests

    @property
    def declared_rate(self) -> float:
        """The rate of the queries."""
        return self.rate * len(self.peers)

    def open(self, ends: Ends) -> None:
        """Makes the publishers, then starts to ask."""
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
        """Peers that did not answer lately."""
        return [peer for peer in self.peers if self._queries.is_silent(peer)]

    def _state_of(self, peer: JausAddress) -> str:
        return "asked" if self._queries.is_silent(peer) else "source"
