"""Topics of ROS while they are recorded: serialized messages as they come. Needs rclpy."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from jausml.live.ros import QuietNode, RosFault, message_class
from jausml.recording.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

    Take = Callable[[str, str, bytes, int, int], None]
    """Takes topic, type, message, and when it was heard and published, in nanoseconds."""

_LOOK = 0.1
"""Seconds from one look for publishers to the next."""

_DEPTH = 1000


class RosTopics:
    """A node that subscribes to what is published, with the quality of service that is offered.

    Attributes:
        wanted: Full names of the topics that are wanted, None for all.
        heard: Topics that were subscribed to.
        missing: Types that are not installed, by topic.
    """

    def __init__(self, wanted: Collection[str] | None, take: Take) -> None:
        """Does nothing before `start`.

        Args:
            wanted: Full names of topics, None for all.
            take: Takes each message, on another thread.
        """
        self.heard: dict[str, Any] = {}
        self.missing: dict[str, str] = {}
        self.wanted = None if wanted is None else frozenset(wanted)
        self._take = take
        self._quiet = QuietNode("record")

    def start(self) -> None:
        """Begins to look for publishers.

        Raises:
            RecordingError: rclpy is missing or does not work.
        """
        try:
            self._quiet.open(lambda node: node.create_timer(_LOOK, self._look))
        except RosFault as error:
            raise RecordingError(str(error)) from error
        self._quiet.spin()

    def stop(self) -> None:
        """Leaves ROS."""
        self._quiet.close()

    def _look(self) -> None:
        for topic, kind in self._published():
            if topic not in self.heard and topic not in self.missing:
                self._subscribe(topic, kind)

    def _published(self) -> Iterator[tuple[str, str]]:
        for topic, kinds in self._quiet.node.get_topic_names_and_types():
            if (self.wanted is None or topic in self.wanted) and len(kinds) == 1:
                yield topic, kinds[0]

    def _subscribe(self, topic: str, kind: str) -> None:
        offered = [
            each.qos_profile for each in self._quiet.node.get_publishers_info_by_topic(topic)
        ]
        if not offered:
            return  # somebody waits for it, as we do
        cls = message_class(kind)
        if cls is None:
            self.missing[topic] = kind
            return
        take = self._take

        def note(data: bytes, told: Any) -> None:
            take(topic, kind, bytes(data), time.time_ns(), told["source_timestamp"])

        self.heard[topic] = self._quiet.node.create_subscription(
            cls, topic, note, _asked(offered), raw=True
        )


def _asked(offered: list[Any]) -> Any:
    """Returns the most of quality of service that all publishers offer."""
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: PLC0415

    is_reliable = all(each.reliability == ReliabilityPolicy.RELIABLE for each in offered)
    is_latched = all(each.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in offered)
    profile: Any = QoSProfile
    return profile(
        depth=_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=(DurabilityPolicy.TRANSIENT_LOCAL if is_latched else DurabilityPolicy.VOLATILE),
    )
