"""What the connections that carry ROS topics to JAUS have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from . import parameters
from .ages import ros_age
from .connection import Connection
from .diagnostics import LOST_IN_QUEUE, MISSED, TOO_OLD
from .joins import JoinedTopic
from .latency import age_of_time
from .light_message import is_light
from .transcoding import Form, ros_decoder, uses_ros_classes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Concatenate

    from ..wire.message import Message
    from .ages import Age
    from .ends import Ends, Feed
    from .joins import Join
    from .quality import TopicFault
    from .topics import Topic
    from .transcoding import Transcode

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")


class FromTopics(Connection[SourceT, TargetT]):
    """What the connections from ROS topics have in common: the topics."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        type: type[SourceT],  # noqa: A002 - the word of the model
        topics: Sequence[Topic],
        message: type[TargetT],
        joins: Sequence[Join] = (),
        **when_lost: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            name: Name of the connection in the model.
            translate: Makes the JAUS message, or None to pass nothing on. Joined topics give it
                their messages as keyword arguments.
            type: ROS type of the topics.
            topics: Topics that are subscribed to.
            message: JAUS message that is made.
            joins: Further topics whose latest message the translation needs.
            when_lost: What happens when the topics are lost: the parameters of `Connection`.
        """
        super().__init__(name, translate, **when_lost)
        self._joined = tuple(map(JoinedTopic, joins))
        self._type = type
        self._topics = tuple(topics)
        self._message = message
        self._feeds: list[Feed] = []

    def open(self, ends: Ends) -> None:
        """Makes the subscriptions; no message is taken before the bridge runs."""
        super().open(ends)
        self._topics = parameters.topics(ends.ros, self.name, self._topics)
        for joined in self._joined:
            joined.open(ends, self.name, real=uses_ros_classes(self._translate))
        if self._joined:
            self._transcode = _with_joins(self._transcode, self._joined)
        take = self.make_take(self._switch)
        self._feeds = [ends.subscribe(self._type, topic, take) for topic in self._topics]

    @property
    def is_latched(self) -> bool:
        """Whether the latest message counts until there is another, as that of a latched topic."""
        latches = any(topic.qos.durability != "volatile" for topic in self._topics)
        return latches and not self.is_command

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns what makes objects of serialized messages."""
        real = uses_ros_classes(self._translate)
        return ros_decoder(self._ends.ros, self._type, real=real)

    def encode(self, target: TargetT) -> bytes:
        """Encodes a JAUS message."""
        return target.encode()

    def readable_form(self) -> Form:
        """Returns which classes the translation is given objects of."""
        is_real = uses_ros_classes(self._translate) or not is_light(self._type)
        return Form.ROS_CLASSES if is_real else Form.LIGHT

    def age(self, data: bytes, origin: Any) -> int | None:  # noqa: ARG002
        """Returns the age of a message by the stamp of its publisher."""
        return age_of_time(origin)

    def make_age(self) -> Age:
        """Returns what tells the age of a message by its stamp, or that of its publisher."""
        return ros_age(self._type, self._ends.ros)

    def topic_faults(self) -> Iterator[TopicFault]:
        """What is wrong with the topics, those of joins included."""
        for source in (self._topics, *(each.topics for each in self._joined)):
            for topic in source:
                yield from self._ends.ros.faults(topic, publishes=False)

    def losses(self) -> dict[str, int]:
        """How many messages of the topics have never been taken."""
        counts = [each.counts for each in self._feeds]
        return {
            LOST_IN_QUEUE: sum(each.lost for each in counts),
            MISSED: sum(each.missed for each in counts),
            TOO_OLD: sum(each.too_old for each in counts),
        }

    def describe_joins(self) -> list[tuple[str, str]]:
        """The joined topics and the age of their latest message."""
        return [
            (f"join {each.join.name} age (s)", "never" if each.age is None else f"{each.age:.3f}")
            for each in self._joined
        ]

    def stale_joins(self) -> list[str]:
        """Names of the joins that have nothing fresh."""
        return [each.join.name for each in self._joined if each.is_stale]


def _with_joins(transcode: Transcode, joined: Sequence[JoinedTopic]) -> Transcode:
    """Returns a translation that is given the latest messages of joins."""

    def transcode_joined(data: bytes) -> bytes | None:
        return transcode(data, **{each.join.name: each.fresh() for each in joined})

    return transcode_joined
