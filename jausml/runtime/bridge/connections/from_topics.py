"""Base class of the connections that carry ROS topics to JAUS."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, Concatenate, TypeVar

from ...base.fast_path import FastSending, Outlet, with_fast_path
from ...wire.message import Message
from ..ends import parameters
from ..ends.ends import Ends, SharedFeed
from ..ends.topics import Topic, TopicFault
from ..reports.diagnostics import FILTERED, LOST_IN_QUEUE, MISSED, TOO_OLD, Age
from .connection import Connection, Take
from .named_places import NamedPlaces
from .shaping import ros_age
from .translations import Form, ros_decoder

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")


class Sink:
    """The function that delivers messages now, and when the latest one was taken."""

    __slots__ = ("deliver", "latest")

    def __init__(self, deliver: Callable[[bytes], bool | None]) -> None:
        self.deliver = deliver  # returns False when it has dropped and counted the message
        # Of the last message: nanoseconds of its publication by the clock of its publisher, and
        # seconds of its arrival by the clock of the bridge.
        self.latest = 0, 0.0


class FromTopics(Connection[SourceT, TargetT]):
    """Base class of the connections from ROS topics: subscribes and translates."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        type: type[SourceT],  # noqa: A002 - the word of the model
        topics: Sequence[Topic],
        message: type[TargetT],
        joins: Sequence[Any] = (),
        named: NamedPlaces | None = None,
        **when_lost: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            translate: Returns the JAUS message, or None to pass nothing on. It is given messages of
                joined topics as keyword arguments.
            joins: The joined topics.
            named: Arrays whose elements are put in order by their names before the translation.
        """
        super().__init__(name, translate, **when_lost)
        self._topic_joins = tuple(joins)
        self._type = type
        self._topics = tuple(topics)
        self._message = message
        self._named = named
        self._feeds: list[SharedFeed] = []
        self._sink = Sink(self.deliver)

    def open(self, ends: Ends) -> None:
        """Makes the subscriptions; no message is taken before the bridge runs."""
        super().open(ends)
        self._topics = parameters.topics(ends.ros, self.name, self._topics)
        for joined in self._topic_joins:
            joined.open(ends, self.name, self._translate)
        self.join(self._topic_joins)
        # A partial, as a bound method cannot carry the fast path.
        take = self._with_fast_path(partial(self.take))
        self._feeds = [ends.shared_topics.feed(self._type, topic, take) for topic in self._topics]

    def pass_on(self, data: bytes, origin: int) -> None:
        """Translates a message and delivers it to JAUS."""
        counts, now, sink = self.statistics, self._ends.clock.now, self._sink
        counts.arrivals += 1
        try:
            target = self._transcode(data)
            # First: the guardian must know of a command before the command is out.
            if self.stopped is not None:
                self.note_usable()
            counts.heard = counts.last_arrival = at = now()
            sink.latest = origin, at
            if target is None:
                self.drop(FILTERED)
                return
            # Senders of a transport return None: they take everything.
            if sink.deliver(target) is False:
                return
        except Exception as error:
            # Not heard: a source that sends nothing usable is silent.
            counts.last_arrival = now()
            self.fail(error)
            return
        counts.passed += 1

    def _with_fast_path(self, take: Take) -> Take:
        """Returns `take`, with a fast path by which the core sends messages without Python."""
        if self.form is not Form.COMPILED:
            return take
        counts, sink, unknown = self.statistics, self._sink, self._note_unknown

        def passed(at: float, stamp: int, left_out: int) -> None:
            counts.arrivals += 1
            counts.heard = counts.last_arrival = at
            counts.passed += 1
            counts.alone += 1
            sink.latest = stamp, at
            if left_out:
                unknown(left_out)

        def find(feed: Any) -> Any:
            # Only the sender to a single peer that obeys has a fast path.
            outlet: Outlet | None = getattr(sink.deliver, "fast_path", lambda: None)()
            if outlet is None or not self.is_direct:
                return None
            translation = self._fast_translation()
            if translation is None:
                return None
            return self._ends.fast_subscriber(feed, FastSending(translation, outlet, passed))

        return with_fast_path(take, find)

    @property
    def has_one_source(self) -> bool:
        """Whether a topic must have one publisher only, as values of two would alternate."""
        return False

    @property
    def is_latched(self) -> bool:
        """Whether the latest message stays valid until the next one: on a latched topic."""
        latches = any(topic.qos.durability != "volatile" for topic in self._topics)
        return latches and not self.is_command

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns the function that decodes serialized ROS messages."""
        decode = ros_decoder(self._ends.ros, self._type, self._translate)
        named = self._named
        return decode if named is None else lambda data: named.reorder(decode(data), self.by_name)

    def encode(self, target: TargetT) -> bytes:
        """Encodes a JAUS message."""
        return target.encode()

    def age(self, data: bytes, origin: Any) -> float | None:  # noqa: ARG002
        """Returns the seconds since a message was published, by the clock of this computer."""
        return (self._ends.loop.wall() - origin) / 1e9 if origin else None

    def age_function(self) -> Age:
        """Returns the function for the age of a message by its stamp, or its publication."""
        return ros_age(self._type, self._ends.ros, self._ends.loop.wall)

    def topic_faults(self) -> Iterator[TopicFault]:
        """Yields the faults of the topics, those of joins included."""
        for topic in self._topics:
            yield from self._ends.ros.faults(topic, publishes=False, alone=self.has_one_source)
        for joined in self._topic_joins:
            for topic in joined.topics:
                yield from self._ends.ros.faults(topic, publishes=False)

    def losses(self) -> dict[str, int]:
        """Returns how many messages of the topics were lost before they were taken, by reason."""
        counts = [feed.counts for feed in self._feeds]
        return {
            LOST_IN_QUEUE: sum(count.lost for count in counts),
            MISSED: sum(count.missed for count in counts),
            TOO_OLD: sum(count.too_old for count in counts),
        }
