"""The bridge as its connections see it (`Ends`), and the topics and messages that they share.

Connections of one topic share its publisher or subscription. Subscriptions are made after all
connections are known, so that a message for a single connection goes to it directly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any, Protocol

from ...base.address import JausAddress
from ...base.clocks import Timing
from ...base.fast_path import FastPath, FastSending, fast_path_of, with_fast_path
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

_MAX_SENDERS = 1024


@dataclass(frozen=True)
class BridgeSettings:
    """Settings of a bridge from its model, apart from its connections.

    Attributes:
        frequency: Messages each second where the model states no rate. Diagnostics come at this
            rate too, but not more often than once a second.
        services: Services that the bridge provides, inherited ones included.
        authority: Authority code that control is requested with, 0 to 255.
        guardian: Makes the `Guardian`, by which a small process sends the stops of a bridge that
            has crashed or stands still; None for none.
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
    """The present report of one or more connections."""

    value: bytes | None = None  # encoded; None while there is no data
    judge_silence: Callable[[], None] | None = None  # of the connection that set it

    def present(self) -> bytes | None:
        """Returns the present report; withdraws it first if it is too old.

        After the process stood still, a query may come before the timer of the silence.
        """
        if self.judge_silence is not None:
            self.judge_silence()
        return self.value


@dataclass(frozen=True)
class Taker:
    """The callbacks of a connection for messages of some senders."""

    take: Take
    senders: PeerBinding | None = None  # senders of its messages; None for any
    refuse: Take | None = None  # for messages of other senders that no connection takes
    is_command: bool = False


class BySender:
    """Distributes messages to the connections that take them from their sender.

    The connections of a sender are looked up once. A message that no connection takes is given to
    the first one with a `refuse`, so that it is counted once.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        """Has no connections yet; `changed` is called when a sender may have other ones."""
        self._changed = changed
        self._takers: list[Taker] = []
        self._takes: dict[JausAddress, tuple[Take, ...]] = {}

    def add(self, taker: Taker) -> None:
        """Adds a connection."""
        self._takers.append(taker)
        self._forget()
        if taker.senders is not None:
            taker.senders.on_change(self._forget)

    @property
    def are_commands(self) -> bool:
        """Whether any of the connections takes commands, of which a new one replaces the last."""
        return any(taker.is_command for taker in self._takers)

    def distributor(self) -> Take:
        """Returns the function that distributes messages: `take` itself of a single open taker."""
        if len(self._takers) == 1 and self._takers[0].senders is None:
            return self._takers[0].take
        takes, find = self._takes, self._find

        def take(data: bytes, sender: JausAddress) -> None:
            for take_one in takes.get(sender) or find(sender):
                take_one(data, sender)

        def fast_path(sender: JausAddress) -> FastPath | None:
            of_sender = takes.get(sender, ())
            return fast_path_of(of_sender[0], sender) if len(of_sender) == 1 else None

        return with_fast_path(take, fast_path)

    def _forget(self) -> None:
        self._takes.clear()
        self._changed()

    def _find(self, sender: JausAddress) -> tuple[Take, ...]:
        takes = [
            taker.take
            for taker in self._takers
            if taker.senders is None or sender in taker.senders.present
        ]
        refusals = [taker.refuse for taker in self._takers if taker.refuse is not None]
        callbacks = self._takes[sender] = tuple(takes or refusals[:1])
        if len(self._takes) > _MAX_SENDERS:  # invented senders must not fill the memory
            self._takes.clear()
        return callbacks


class SharedTopics:
    """The publishers and subscriptions of a bridge, one for each topic, type and QoS."""

    def __init__(self, ros: RosSide) -> None:
        self._ros = ros
        self._publishers: dict[tuple[type[Any], Topic, bool], RosPublisher] = {}
        self._match_callbacks: dict[tuple[type[Any], Topic, bool], list[Callable[[], None]]] = {}
        self._feeds: dict[tuple[type[Any], Topic], SharedFeed] = {}

    def publisher(
        self, message_type: type[Any], topic: Topic, on_match: Callable[[], None] | None
    ) -> RosPublisher:
        """Returns the publisher of a topic; `on_match` is called for each subscriber found."""
        # Publishers without a callback are apart: to look for subscribers costs time.
        key = (message_type, topic, on_match is not None)
        callbacks = self._match_callbacks.setdefault(key, [])
        if on_match is not None:
            callbacks.append(on_match)
        if key not in self._publishers:
            call_all = (lambda: _call_all(callbacks)) if on_match is not None else None
            self._publishers[key] = self._ros.publisher(message_type, topic, call_all)
        return self._publishers[key]

    def feed(self, message_type: type[Any], topic: Topic, take: Take) -> SharedFeed:
        """Returns the subscription of a topic, which `subscribe` makes later."""
        feed = self._feeds.setdefault((message_type, topic), SharedFeed())
        feed.takers.append(take)
        return feed

    def subscribe(self) -> None:
        """Makes the subscriptions, in the order of the calls of `feed`."""
        for (message_type, topic), feed in self._feeds.items():
            feed.counts = self._ros.subscribe(message_type, topic, to_all(feed.takers))


class SharedFeed:
    """The subscription of a topic: the functions that take its messages, and its counts."""

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
        """Calls `note` with each report of a peer that no connection takes as a message."""
        by_sender = self._unasked.setdefault(message, self._by_sender())
        by_sender.add(Taker(note, peers, self._count_unknown))

    def _by_sender(self) -> BySender:
        return BySender(self._component.loop.revision.changed)

    def _count_unknown(self, _data: bytes, _sender: JausAddress) -> None:
        self._component.counters.add("component.unknown_message")

    def accept(self, message: type[Message], taker: Taker, when: When) -> None:
        """Registers a connection for a message; `handle` begins to take it.

        Args:
            when: Guard of the messages; connections of one command have the same.
        """
        if when is Guard.ANY:
            self._listeners.setdefault(message, self._by_sender()).add(taker)
        else:
            self._commands.setdefault(message, (when, self._by_sender()))[1].add(taker)

    def handle(self) -> None:
        """Begins to take the registered messages."""
        for message, listeners in self._listeners.items():
            if message.CODE in (SetEmergency.CODE, ClearEmergency.CODE):
                self._component.part(ManagementService).watch_emergency(
                    message, listeners.distributor()
                )
                continue
            self._component.on_payload(
                message,
                listeners.distributor(),
                is_robust=True,
                counts_each=not listeners.are_commands,
            )
        for message, by_sender in self._unasked.items():
            self._component.watch_unwanted(message, by_sender.distributor())
        for message, (when, by_sender) in self._commands.items():
            self._component.handle_payload(
                message, by_sender.distributor(), when=when, is_robust=True
            )

    def report(self, query: type[Message], report: type[Message]) -> ReportHolder:
        """Offers a report, and returns its holder, which all connections of the report share."""
        if query not in self._reports:
            holder = self._reports[query] = ReportHolder()
            self._component.provide(query, report, lambda _query, _sender: holder.present())
        return self._reports[query]


def to_all(takers: Sequence[Take]) -> Take:
    """Returns a function that gives each message to all takers; a single taker itself."""
    if len(takers) == 1:
        return takers[0]
    takers = tuple(takers)

    def take(data: bytes, origin: Any) -> None:
        for taker in takers:
            taker(data, origin)

    return take


def _call_all(callbacks: Sequence[Callable[[], None]]) -> None:
    for callback in callbacks:
        callback()


class Ends(Protocol):
    """The attributes of a bridge that its connections need; `Bridge` implements it."""

    settings: BridgeSettings
    clock: Timing  # for ages and time-outs of messages: that of the loop, or of a simulation
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
        """Returns the compiled function of a translation; None if its library is not loaded.

        Args:
            note: Called with the path of each field that is left out, as its value is no number.
        """

    def fast_translation(self, compiled: Compiled) -> Any:
        """Returns a translation for the core to run without Python; None where it needs Python."""

    def fast_subscriber(self, feed: Any, path: FastSending) -> Any:
        """Returns the taker by which the core reads a subscription itself; None without a core."""

    def frozen_at(self, moment: Time) -> AbstractContextManager[None]:
        """Makes `now` of the bridge return `moment` within the block."""
