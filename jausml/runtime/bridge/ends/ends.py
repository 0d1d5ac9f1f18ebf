"""A bridge as its connections see it, and what they share: topics, commands, reports.

Connections that name a topic alike have one publisher or subscription. What arrives for one
connection alone goes to it without a detour; so subscriptions and commands are made when all
connections have said what they want.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any, Protocol

from ...base.address import JausAddress
from ...base.clocks import Timing
from ...base.fast_path import FastPath, FastSending, fast_path_of, through
from ...base.loop import Loop
from ...base.settings import TransportSettings
from ...clients.peer_binding import PeerBinding
from ...component.base import COMPONENT_TYPE, Component
from ...conversions import Time
from ...messages import ClearEmergency, SetEmergency
from ...services.definitions import ComponentSettings, Guard, ServiceIdentity
from ...services.management import ManagementService
from ...wire.message import Message
from ..messages.compiled import Compiled, Function
from .ros_side import RosPublisher, RosSide
from .simulation import Simulation
from .topics import Topic, TopicCounts

Take = Callable[[bytes, Any], None]
When = Guard | Callable[[Any], Guard]

_MOST_SENDERS = 1024


@dataclass(frozen=True)
class BridgeSettings:
    """What the model says about a bridge, apart from its connections.

    Attributes:
        frequency: Messages each second where the model states no rate. Diagnostics come at this
            rate too, but not more often than once a second.
        services: Services that the bridge provides, inherited ones included.
        authority: Authority code that control is requested with, 0 to 255.
        guardian: What has a small process beside the bridge say its stops when the bridge cannot.
    """

    name: str
    address: JausAddress
    description: str = ""
    namespace: str = ""
    frequency: float = 1.0
    services: tuple[ServiceIdentity, ...] = ()
    component_type: int = COMPONENT_TYPE
    authority: int = 127
    component: ComponentSettings = field(default_factory=ComponentSettings)
    transport: TransportSettings = field(default_factory=TransportSettings)
    guardian: Callable[..., Any] | None = None


@dataclass(slots=True)
class ReportHolder:
    """The present report that topics feed."""

    value: bytes | None = None  # encoded; None before their first message
    judge_silence: Callable[[], None] | None = None  # of the connection that spoke last

    def present(self) -> bytes | None:
        """Returns the report that counts now.

        What is too old is withdrawn here too: after a halt of the process, whoever asks may come
        before the timer of the silence.
        """
        if self.judge_silence is not None:
            self.judge_silence()
        return self.value


@dataclass(frozen=True)
class Taker:
    """A connection that takes messages."""

    take: Take
    senders: PeerBinding | None = None  # whose messages it takes; None for those of anybody
    refuse: Take | None = None
    is_command: bool = False


class BySender:
    """Finds the connections for a sender once, however many there are.

    A message that no connection wants is counted by the first one that names its senders, once.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        """Tells of changes when messages of a sender may go to others than before."""
        self._changed = changed
        self._takers: list[Taker] = []
        self._known: dict[JausAddress, tuple[Take, ...]] = {}

    def add(self, taker: Taker) -> None:
        """Adds a connection."""
        self._takers.append(taker)
        self._forget()
        if taker.senders is not None:
            taker.senders.on_change(self._forget)

    @property
    def are_commands(self) -> bool:
        """Whether a message takes the place of the one before, for any of the connections."""
        return any(taker.is_command for taker in self._takers)

    def taking(self) -> Take:
        """Returns what takes all messages: the connection itself that alone takes anybody's."""
        if len(self._takers) == 1 and self._takers[0].senders is None:
            return self._takers[0].take
        known, find = self._known, self._find

        def take(data: bytes, sender: JausAddress) -> None:
            for taker in known.get(sender) or find(sender):
                taker(data, sender)

        def fast_path(sender: JausAddress) -> FastPath | None:
            takers = known.get(sender, ())
            return fast_path_of(takers[0], sender) if len(takers) == 1 else None

        return through(take, fast_path)

    def _forget(self) -> None:
        self._known.clear()
        self._changed()

    def _find(self, sender: JausAddress) -> tuple[Take, ...]:
        wanting = [
            taker.take
            for taker in self._takers
            if taker.senders is None or sender in taker.senders.present
        ]
        refusing = [taker.refuse for taker in self._takers if taker.refuse is not None]
        callbacks = self._known[sender] = tuple(wanting or refusing[:1])
        if len(self._known) > _MOST_SENDERS:  # inventions of a peer must not fill the memory
            self._known.clear()
        return callbacks


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

    def __init__(self, component: Component) -> None:
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

        Whom to obey may depend on the message; a command has one handler, which its connections
        share.
        """
        if when is Guard.ANY:
            self._listeners.setdefault(message, self._by_sender()).add(taker)
        else:
            self._commands.setdefault(message, (when, self._by_sender()))[1].add(taker)

    def handle(self) -> None:
        """Begins to take the messages that were asked for."""
        for message, listeners in self._listeners.items():
            if message.CODE in (SetEmergency.CODE, ClearEmergency.CODE):
                self._component.part(ManagementService).watch_emergency(message, listeners.taking())
                continue
            self._component.on_payload(
                message, listeners.taking(), is_robust=True, counts_each=not listeners.are_commands
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
        for taker in several:
            taker(data, origin)

    return take


def _tell(greeters: Sequence[Callable[[], None]]) -> None:
    for greet in greeters:
        greet()


class Ends(Protocol):
    """A bridge as its connections see it; `Bridge` is the one."""

    settings: BridgeSettings
    clock: Timing  # by which messages are late: that of the loop, or of a simulation
    simulation: Simulation | None
    ward: Any  # the `Guardian`, where the model asks for one
    ros: RosSide
    component: Component
    shared_topics: SharedTopics
    shared_messages: SharedMessages

    @property
    def loop(self) -> Loop:
        """The loop of the JAUS side."""

    def compiled(self, compiled: Compiled, note: Callable[[str], None]) -> Function | None:
        """Returns the function of a translation; None where its library is not there.

        A field that is left out, as its value is no number, is noted.
        """

    def fast_translation(self, compiled: Compiled) -> Any:
        """Returns what a core is given to translate alone; None where Python has a part in it."""

    def fast_subscriber(self, feed: Any, path: FastSending) -> Any:
        """Returns a core that takes the messages of a subscription; None where none can."""

    def at(self, moment: Time) -> AbstractContextManager[None]:
        """Lets translations take a moment for the present."""
