"""Connections that publish JAUS messages on ROS topics."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, Concatenate, TypeVar

from ...base.address import JausAddress
from ...base.fast_path import FastPath, with_fast_path
from ...clients.peer_binding import PeerBinding, Search
from ...conversions import Time
from ...services.definitions import Guard, Status
from ...wire.message import Message
from ..ends import parameters
from ..ends.ends import Ends, Taker
from ..ends.ros_side import RosPublisher
from ..ends.topics import Topic, TopicFault
from ..reports.diagnostics import FILTERED, UNHEARD, Age
from ..reports.states import Standing, StopReason
from .connection import Connection, Take
from .shaping import RateCap, jaus_age
from .translations import Form, Transcode, ros_encoder

SourceT = TypeVar("SourceT", bound="Message")
TargetT = TypeVar("TargetT")

NOT_PUBLISHED = "not_published"
UNEXPECTED = "unexpected_source"

_DISCOVERY_S = 10.0  # after the start, in which ROS may still find subscribers from before it


class ToTopics(Connection[SourceT, TargetT]):
    """Base class of the connections to ROS topics: translates and publishes."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        message: type[SourceT],
        type: type[TargetT],  # noqa: A002 - the word of the model
        topics: Sequence[Topic],
        peers: Sequence[JausAddress] | Search = (),
        joins: Sequence[Any] = (),
        **when_lost: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            translate: Returns the ROS message, or None to pass nothing on. It is given the messages
                of joined reports as keyword arguments.
            peers: JAUS components whose messages are taken, or how they are found; none means all.
            joins: The joined reports.
        """
        super().__init__(name, translate, **when_lost)
        self._peers = PeerBinding(peers)
        self._report_joins = tuple(joins)
        self._message = message
        self._type = type
        self._topics = tuple(topics)
        self._publishers: list[RosPublisher] = []
        self._publisher: RosPublisher | _Publishers
        self._encode: Callable[[Any], bytes]
        self._opened = 0.0

    @property
    def peers(self) -> tuple[JausAddress, ...]:
        """JAUS components whose messages are taken."""
        return self._peers.present

    def open(self, ends: Ends) -> None:
        """Makes the publishers, before any message can arrive."""
        self._encode = ros_encoder(ends.ros, self._type)
        super().open(ends)
        self._topics = parameters.topics(ends.ros, self.name, self._topics)
        self._peers = parameters.peers(ends.ros, self.name, self._peers)
        self._opened = ends.loop.now()
        on_match = (
            self._send_start_stop if self.is_command and self._safe_value is not None else None
        )
        self._publishers = [
            ends.shared_topics.publisher(self._type, topic, on_match) for topic in self._topics
        ]
        # The core publishes on one topic only: `_Publishers` has no address.
        only = self._publishers[0] if len(self._publishers) == 1 else None
        self._publisher = only or _Publishers(self._publishers)
        self.guard()
        for report_join in self._report_joins:
            report_join.open(ends, self.name, self._peers, self._refuse_sender)
        self.join(self._report_joins)
        # A partial, as a bound method cannot carry the fast path.
        self._take = self._with_fast_path(partial(self.take))
        self.begin(ends)
        # Last, as a peer may answer as soon as it is asked.
        self._peers.follow(ends.component, self._join, self._leave)

    def begin(self, ends: Ends) -> None:
        """Prepares for the peers; called before any of them joins. Does nothing by default."""

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns the function that decodes the JAUS message."""
        return self._message.decode

    def encode(self, target: TargetT) -> bytes:
        """Serializes a ROS message."""
        return self._encode(target)

    def pass_on(self, data: bytes, origin: Any) -> None:  # noqa: ARG002
        """Translates a message and publishes it."""
        counts, now, publisher = self.statistics, self._ends.clock.now, self._publisher
        target, failure = None, None
        try:
            target = self._transcode(data)
        except Exception as error:
            counts.arrivals += 1
            counts.last_arrival = now()
            self.fail(error)
            return
        # First: the guardian must know of a command before the command is out.
        if self.stopped is not None:
            self.note_usable()
        if target is not None:
            try:
                publisher.publish(target)
            except Exception as error:
                failure = error
        # Counted after the message was published, so that it is not delayed.
        counts.arrivals += 1
        counts.heard = counts.last_arrival = now()
        if target is None:
            self.drop(FILTERED)
        elif failure is not None:
            self._note_refused(failure)
        else:
            counts.passed += 1
            if not publisher.matched:
                publisher.unmatched += 1

    def _with_fast_path(self, take: Take) -> Take:
        """Returns `take`, with a fast path by which the core publishes messages without Python."""
        address = getattr(self._publisher, "address", 0)
        if self.form is not Form.COMPILED or not address:
            return take
        counts, publisher, unknown = self.statistics, self._publisher, self._note_unknown

        def passed(_payload: bytes, _number: int, at: float, left_out: int) -> None:
            counts.arrivals += 1
            counts.heard = counts.last_arrival = at
            counts.passed += 1
            counts.alone += 1
            if not publisher.matched:
                publisher.unmatched += 1
            if left_out:
                unknown(left_out)

        def find(_sender: JausAddress) -> FastPath | None:
            translation = self._fast_translation() if self.is_direct else None
            if translation is None:
                return None
            return FastPath(self._message.CODE, translation, address, passed)

        return with_fast_path(take, find)

    def age(self, data: bytes, origin: Any) -> float | None:
        """Returns the age of a message by its TimeStamp and the clock of this computer."""
        wall = Time(*divmod(self._ends.loop.wall(), 10**9))
        return jaus_age(self._message, lambda: wall)(data, origin)

    def age_function(self) -> Age:
        """Returns the function for the age of a message by its TimeStamp and the ROS clock."""
        return jaus_age(self._message, self._ends.ros.now)

    def _join(self, peer: JausAddress) -> None:
        """Subscribes at a new peer; does nothing by default."""

    def _leave(self, peer: JausAddress) -> None:
        """Ends the subscription at a peer that has gone; does nothing by default."""

    def _refuse_sender(self, _data: bytes, sender: JausAddress) -> None:
        """Counts a message of a sender that is no peer of any connection."""
        self.refuse(UNEXPECTED, str(sender))

    def lacks_peers(self) -> str:
        """Returns which peer is searched for and not found."""
        return str(self._peers.search) if self._peers.is_lacking else ""

    def _send_start_stop(self) -> None:
        """Repeats the stop of the start for a subscriber that ROS has just found.

        After a crash and restart of the bridge the robot may be in motion. Later subscribers get no
        stop, since other nodes may publish on the topic by then.
        """
        with self._ends.loop.lock:
            is_new = self._ends.loop.now() - self._opened < _DISCOVERY_S
            if self.stopped is StopReason.START and is_new:
                self.send_safe_value(self.deliver)

    def guarded_stops(self, payload: bytes) -> dict[str, Any]:
        """Returns the stop for each topic."""
        return {"topics": self._ends.ward.topic_stops(self._publishers, payload)}

    def deliver(self, payload: bytes) -> bool:
        """Publishes on every topic; returns False when ROS refuses."""
        try:
            self._publisher.publish(payload)
        except Exception as error:
            self._note_refused(error)
            return False
        if not self._publisher.matched:
            self._publisher.unmatched += 1
        return True

    def _note_refused(self, error: Exception) -> None:
        self.drop(NOT_PUBLISHED, repr(error), error)

    def losses(self) -> dict[str, int]:
        """Returns how many messages were published without a subscriber."""
        return {UNHEARD: sum(publisher.unmatched for publisher in self._publishers)}

    def topic_faults(self) -> Iterator[TopicFault]:
        """Yields the faults of the topics."""
        for topic in self._topics:
            yield from self._ends.ros.faults(topic, publishes=True)

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns the JAUS components whose messages are taken, and their states."""
        named = [(f"peer {peer}", self._state_of(peer)) for peer in self.peers]
        return [*self._peers.describe(), *named]

    def _state_of(self, peer: JausAddress) -> str:  # noqa: ARG002
        return "source"


class MessageToTopics(ToTopics[SourceT, TargetT]):
    """Publishes each message of a kind that a JAUS component sends to the bridge.

    Without peers, messages are taken from any component.
    """

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        when: Guard | Callable[[SourceT], Guard] = Guard.ANY,
        rate_cap: float = 0.0,
        answer: Any = None,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            when: Guard of the messages: any sender, the controller of the bridge, or the
                controller in Ready. A function returns it for a message.
            rate_cap: Most messages each second that are taken of one source; 0 means all.
            answer: The `CommandAnswer` to queries for the last command.
        """
        super().__init__(name, translate, **options)
        self._when = when
        self._standing: Standing | None = None
        self._rate_cap = rate_cap
        self._answer = answer

    def open(self, ends: Ends) -> None:
        """Makes the publishers, then takes messages."""
        super().open(ends)
        self._rate_cap = ends.ros.parameter(parameters.RATE_CAP.of(self._rate_cap, self.name))
        if self._rate_cap > 0:
            self._take = RateCap(self._rate_cap, ends.loop.now, self.refuse).before(self._take)
        senders = None if self._peers.is_anybody else self._peers
        taker = Taker(self._take, senders, self._refuse_sender, self.is_command)
        ends.shared_messages.accept(self._message, taker, self._when)
        if self._answer is not None:
            self._answer.provide(ends.component)

    def _make_transcode(self) -> Transcode:
        transcode = super()._make_transcode()
        return transcode if self._answer is None else self._answer.remembering(transcode)

    @property
    def is_translated_alone(self) -> bool:
        """Whether commands need not be kept for queries."""
        return self._answer is None

    def deliver_stop(self, payload: bytes) -> bool:
        """Publishes the stop, and forgets the last command, which is not in effect any more.

        Without a stop the last command stays in effect after its source has stopped.
        """
        if self._answer is not None:
            self._answer.forget()
        return super().deliver_stop(payload)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops commands of a lost controller, and those that the present state forbids."""
        self._standing = standing
        if not (self.is_command and standing.is_active):
            return super().follow(standing, lost)
        # With another guard, the component itself refuses messages before they come here.
        if self.halt(standing.halt if self._when is Guard.ANY else None):
            return True
        return lost is not None and self.stop(lost)

    def forbidden(self) -> str:
        """Returns why no command is obeyed now; empty while commands are."""
        standing = self._standing
        if self._halt is not None or self._when is Guard.ANY or standing is None:
            return super().forbidden()
        if standing.halt is not None:
            return standing.halt.value
        if standing.controller is None:
            why = standing.without_controller
            return why.value if self.stopped is why else "nobody controls the bridge"
        waits = self._when is Guard.READY and standing.status is not Status.READY
        return StopReason.STANDBY.value if waits else ""

    def not_taken(self) -> dict[str, int]:
        """Returns how many messages of peers the component refused or could not read, by reason."""
        counts_by_reason: Counter[str] = Counter()
        for sender, reason, count in self._ends.component.drops_before(self._message.NAME):
            if self._peers.is_anybody or sender in self._peers.present:
                counts_by_reason[reason] += count
        return dict(counts_by_reason)

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns the JAUS components whose messages are taken, and their states."""
        return super().describe_peers() or [("peer", "any")]


class _Publishers:
    """Several publishers as one."""

    # Constant, as each of the publishers counts its own messages.
    matched = 1
    unmatched = 0

    def __init__(self, publishers: Sequence[RosPublisher]) -> None:
        self._publishers = tuple(publishers)

    def publish(self, data: bytes) -> None:
        for publisher in self._publishers:
            publisher.publish(data)
            if not publisher.matched:
                publisher.unmatched += 1
