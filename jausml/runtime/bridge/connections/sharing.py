"""What connections of one bridge share: publishers, subscriptions, commands and reports.

Connections that name a topic alike have one publisher or subscription. What arrives for one
connection alone goes to it without a detour; so subscriptions and commands are made when all
connections have said what they want.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...services.definitions import Guard
from ..ends.by_sender import BySender, Taker
from ..ends.ends import ReportHolder
from ..ends.topics import TopicCounts

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...base.address import JausAddress
    from ...clients.peer_search import PeerBinding
    from ...component.component import JausComponent
    from ...wire.message import Message
    from ..ends.ends import RosPublisher, RosSide
    from ..ends.topics import Topic

    When = Guard | Callable[[Any], Guard]
    Take = Callable[[bytes, Any], None]


class SharedTopics:
    """The topics of a bridge."""

    def __init__(self, ros: RosSide) -> None:
        self._ros = ros
        self._publishers: dict[tuple[type[Any], Topic, bool], RosPublisher] = {}
        self._greeters: dict[tuple[type[Any], Topic, bool], list[Callable[[], None]]] = {}
        self._feeds: dict[tuple[type[Any], Topic], SharedFeed] = {}

    def publisher(
        self, message_type: type[Any], topic: Topic, greet: Callable[[], None] | None
    ) -> RosPublisher:
        """Returns the publisher of a topic."""
        # Whoever does not ask for subscribers does not pay for them.
        key = (message_type, topic, greet is not None)
        greeters = self._greeters.setdefault(key, [])
        if greet is not None:
            greeters.append(greet)
        if key not in self._publishers:
            tell = (lambda: _tell(greeters)) if greet is not None else None
            self._publishers[key] = self._ros.publisher(message_type, topic, tell)
        return self._publishers[key]

    def feed(self, message_type: type[Any], topic: Topic, take: Take) -> SharedFeed:
        """Returns the subscription of a topic, which `subscribe` makes."""
        feed = self._feeds.setdefault((message_type, topic), SharedFeed())
        feed.takers.append(take)
        return feed

    def subscribe(self) -> None:
        """Makes the subscriptions that were asked for, in that order."""
        for (message_type, topic), feed in self._feeds.items():
            feed.counts = self._ros.subscribe(message_type, topic, to_each(feed.takers))


class SharedFeed:
    """The subscription of a topic."""

    def __init__(self) -> None:
        self.takers: list[Take] = []
        self.counts = TopicCounts()


class SharedMessages:
    """The messages of other components that a bridge takes, and the reports that it offers."""

    def __init__(self, component: JausComponent) -> None:
        self._component = component
        self._listeners: dict[type[Message], BySender] = {}
        self._commands: dict[type[Message], tuple[When, BySender]] = {}
        self._reports: dict[type[Message], ReportHolder] = {}
        self._unasked: dict[type[Message], BySender] = {}

    def note_unasked(self, message: type[Message], note: Take, peers: PeerBinding) -> None:
        """Tells of reports of peers that nobody takes, since they are asked for in another way."""
        noting = self._unasked.setdefault(message, self._by_sender())
        noting.add(Taker(note, peers, self._count_unknown))

    def _by_sender(self) -> BySender:
        return BySender(self._component.loop.revision.changed)

    def _count_unknown(self, _data: bytes, _sender: JausAddress) -> None:
        self._component.counters.add("component.unknown_message")

    def accept(self, message: type[Message], taker: Taker, when: When) -> None:
        """Takes messages that others send, of whom `handle` says more.

        Args:
            when: Whom to obey, or a function that tells it from the message; a command has one
                handler, which its connections share.
        """
        if when is Guard.ANY:
            self._listeners.setdefault(message, self._by_sender()).add(taker)
        else:
            self._commands.setdefault(message, (when, self._by_sender()))[1].add(taker)

    def handle(self) -> None:
        """Begins to take the messages that were asked for."""
        for message, listeners in self._listeners.items():
            self._component.on_payload(
                message,
                listeners.taking(),
                is_robust=True,
                counts_each=not listeners.are_commands,
            )
        for message, noting in self._unasked.items():
            self._component.watch_unwanted(message, noting.taking())
        for message, (when, takers) in self._commands.items():
            self._component.handle_payload(message, takers.taking(), when=when, is_robust=True)

    def report(self, query: type[Message], report: type[Message]) -> ReportHolder:
        """Offers a report; connections that feed one report share its value."""
        if query not in self._reports:
            holder = self._reports[query] = ReportHolder()
            self._component.provide(query, report, lambda _query, _sender: holder.present())
        return self._reports[query]


def to_each(takers: Sequence[Take]) -> Take:
    """Returns what gives each message to all takers; the only one itself, if it is alone."""
    if len(takers) == 1:
        return takers[0]
    several = tuple(takers)

    def take(data: bytes, origin: Any) -> None:
        for each in several:
            each(data, origin)

    return take


def _tell(greeters: Sequence[Callable[[], None]]) -> None:
    for greet in greeters:
        greet()
