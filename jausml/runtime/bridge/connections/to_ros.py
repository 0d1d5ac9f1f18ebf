"""Connections that carry JAUS messages to ROS topics."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, Concatenate, TypeVar

from ...base.address import JausAddress
from ...base.fast_path import FastPath, through
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

_GREETING = 10.0
"""Seconds after the start in which subscribers may still be found that were there before."""


class ToTopics(Connection[SourceT, TargetT]):
    """What the connections to ROS topics have in common: the topics, and the peers."""

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

        The translation makes the ROS message, or None to pass nothing on; joined reports give it
        their messages as keyword arguments.
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
        greet = self._greet if self.is_command and self._safe_value is not None else None
        self._publishers = [
            ends.shared_topics.publisher(self._type, topic, greet) for topic in self._topics
        ]
        # Of several no core can take charge: `_Publishers` has no address.
        only = self._publishers[0] if len(self._publishers) == 1 else None
        self._publisher = only or _Publishers(self._publishers)
        self.guard()
        for report_join in self._report_joins:
            report_join.open(ends, self.name, self._peers, self._refuse_sender)
        self.join(self._report_joins)
        # A partial, as a bound method cannot carry the fast path.
        self._take = self._through(partial(self.take))
        self.begin(ends)
        # At last: a peer may answer as soon as it is asked.
        self._peers.follow(ends.component, self._join, self._leave)

    def begin(self, ends: Ends) -> None:
        """Prepares to meet the peers; by default nothing is to be done."""

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns what decodes the JAUS message."""
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
        # What is only counted is counted when the message has gone on.
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

    def _through(self, take: Take) -> Take:
        """Returns what takes messages, with the fast path of those that a core publishes."""
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
            translation = self._fast_translation() if self.is_usual else None
            if translation is None:
                return None
            return FastPath(self._message.CODE, translation, address, passed)

        return through(take, find)

    def age(self, data: bytes, origin: Any) -> float | None:
        """Returns the age of a message with a TimeStamp."""
        wall = Time(*divmod(self._ends.loop.wall(), 10**9))
        return jaus_age(self._message, lambda: wall)(data, origin)

    def make_age(self) -> Age:
        """Returns what tells the age of a message by its TimeStamp."""
        return jaus_age(self._message, self._ends.ros.now)

    def _join(self, peer: JausAddress) -> None:
        """Begins with a peer; by default nothing is to be asked of it."""

    def _leave(self, peer: JausAddress) -> None:
        """Ends with a peer that is gone."""

    def _refuse_sender(self, _data: bytes, sender: JausAddress) -> None:
        """Counts a message that no connection takes from its sender."""
        self.refuse(UNEXPECTED, str(sender))

    def lacks_peers(self) -> str:
        """What is searched for and not found."""
        return str(self._peers.search) if self._peers.is_lacking else ""

    def _greet(self) -> None:
        """Gives the stop of the start to subscribers that ROS finds a little later.

        A bridge that crashed and was started again finds the robot in motion. Afterwards a
        newcomer gets nothing: others may publish on the topic by then.
        """
        with self._ends.loop.lock:
            is_new = self._ends.loop.now() - self._opened < _GREETING
            if self.stopped is StopReason.START and is_new:
                self.send_safe_value(self.deliver)

    def guarded_stops(self, payload: bytes) -> dict[str, Any]:
        """Returns the stop for each topic."""
        return {"topics": self._ends.ward.topic_stops(self._publishers, payload)}

    def deliver(self, payload: bytes) -> bool:
        """Publishes on every topic; False when ROS refuses."""
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
        """How many messages nobody has heard."""
        return {UNHEARD: sum(publisher.unmatched for publisher in self._publishers)}

    def topic_faults(self) -> Iterator[TopicFault]:
        """What is wrong with the topics."""
        for topic in self._topics:
            yield from self._ends.ros.faults(topic, publishes=True)

    def describe_peers(self) -> list[tuple[str, str]]:
        """The JAUS components whose messages are taken."""
        named = [(f"peer {peer}", self._state_of(peer)) for peer in self.peers]
        return [*self._peers.describe(), *named]

    def _state_of(self, peer: JausAddress) -> str:  # noqa: ARG002
        return "source"


class MessageToTopics(ToTopics[SourceT, TargetT]):
    """Publishes each message of a kind that a JAUS component sends to the bridge.

    Without peers, messages are taken from whoever sends them.
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
            when: Whom to obey: commands pass only from the controller of the bridge. A function
                tells it from the message.
            rate_cap: Messages each second that are taken of one source; 0 means all.
            answer: The `CommandAnswer` of who asks for the last command that was passed on.
        """
        super().__init__(name, translate, **options)
        self._when = when
        self._standing: Standing | None = None
        self._rate_cap = rate_cap
        self._memory = answer

    def open(self, ends: Ends) -> None:
        """Makes the publishers, then listens."""
        super().open(ends)
        self._rate_cap = ends.ros.parameter(parameters.RATE_CAP.of(self._rate_cap, self.name))
        if self._rate_cap > 0:
            self._take = RateCap(self._rate_cap, ends.loop.now, self.refuse).before(self._take)
        senders = None if self._peers.is_anybody else self._peers
        taker = Taker(self._take, senders, self._refuse_sender, self.is_command)
        ends.shared_messages.accept(self._message, taker, self._when)
        if self._memory is not None:
            self._memory.provide(ends.component)

    def _made_transcode(self) -> Transcode:
        transcode = super()._made_transcode()
        return transcode if self._memory is None else self._memory.remembering(transcode)

    @property
    def is_translated_alone(self) -> bool:
        """Whether no command is to be remembered for who asks."""
        return self._memory is None

    def deliver_stop(self, payload: bytes) -> bool:
        """Publishes the stop, after which no command stands that could be told.

        Without one the last command stands on, whatever stopped its source.
        """
        if self._memory is not None:
            self._memory.forget()
        return super().deliver_stop(payload)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops what whoever commanded has left behind, in Ready too."""
        self._standing = standing
        if not (self.is_command and standing.is_active):
            return super().follow(standing, lost)
        # Of other commands the guard decides, which the bridge asks before it takes a message.
        if self.halt(standing.halt if self._when is Guard.ANY else None):
            return True
        return lost is not None and self.stop(lost)

    def forbidden(self) -> str:
        """Why no command is obeyed now."""
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
        """How many messages were refused, late or unreadable, and never came as far as this."""
        counts_by_reason: Counter[str] = Counter()
        for sender, reason, count in self._ends.component.drops_before(self._message.NAME):
            if self._peers.is_anybody or sender in self._peers.present:
                counts_by_reason[reason] += count
        return dict(counts_by_reason)

    def describe_peers(self) -> list[tuple[str, str]]:
        """The JAUS components whose messages are taken."""
        return super().describe_peers() or [("peer", "any")]


class _Publishers:
    """Several publishers as one."""

    # For whoever asks: each of the publishers counts its own.
    matched = 1
    unmatched = 0

    def __init__(self, publishers: Sequence[RosPublisher]) -> None:
        self._publishers = tuple(publishers)

    def publish(self, data: bytes) -> None:
        for publisher in self._publishers:
            publisher.publish(data)
            if not publisher.matched:
                publisher.unmatched += 1
