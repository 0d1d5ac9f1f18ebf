"""What messages on topics say once and for all: names of joints and of frames. Needs rclpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.live.ros.node import message_class

if TYPE_CHECKING:
    from collections.abc import Iterable
    from threading import Condition

    from jausml.live.ros.graph import RunningTopic

_JOINTS = "sensor_msgs/msg/JointState"


class Hearing:
    """The first message on each topic whose messages name joints or frames.

    Attributes:
        joints: Names of the joints by the topic on which a node publishes them.
        frames: `header.frame_id` and `child_frame_id` of the messages, by topic; an empty text for
            one that they do not name.
    """

    def __init__(self, node: Any, topics: Iterable[RunningTopic], come: Condition) -> None:
        """Subscribes to what is published.

        Args:
            come: Told of each first message.
        """
        self.joints: dict[str, tuple[str, ...]] = {}
        self.frames: dict[str, tuple[str, str]] = {}
        self._come = come
        self._waiting: set[str] = set()
        for each in topics:
            cls = message_class(each.types[0]) if each.publishers and len(each.types) == 1 else None
            if cls is not None and "header" in cls.get_fields_and_field_types():
                self._waiting.add(each.name)
                self._subscribe(node, each, cls)

    @property
    def silent(self) -> tuple[str, ...]:
        """The topics on which nothing has come yet."""
        return tuple(sorted(self._waiting))

    def _subscribe(self, node: Any, topic: RunningTopic, cls: Any) -> None:
        from rclpy.serialization import deserialize_message  # noqa: PLC0415

        def take(data: bytes) -> None:
            with self._come:
                if topic.name not in self._waiting:
                    return  # Images and clouds are large: each is read once.
                self._note(topic, deserialize_message(data, cls))
                self._waiting.discard(topic.name)
                self._come.notify_all()

        node.create_subscription(cls, topic.name, take, _asked(topic), raw=True)

    def _note(self, topic: RunningTopic, message: Any) -> None:
        if topic.types == (_JOINTS,):
            self.joints[topic.name] = tuple(message.name)
        frames = (message.header.frame_id, getattr(message, "child_frame_id", ""))
        if any(frames):
            self.frames[topic.name] = frames


def _asked(topic: RunningTopic) -> Any:
    """Returns what all publishers offer: what was published before, where all of them keep it."""
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: PLC0415

    profile: Any = QoSProfile
    is_kept = all(each.durability == "transient_local" for each in topic.publishers)
    is_sure = all(each.reliability == "reliable" for each in topic.publishers)
    return profile(
        depth=1,
        reliability=(
            ReliabilityPolicy.RELIABLE if is_kept and is_sure else ReliabilityPolicy.BEST_EFFORT
        ),
        durability=(DurabilityPolicy.TRANSIENT_LOCAL if is_kept else DurabilityPolicy.VOLATILE),
    )
