"""Listens to `/diagnostics`, and to one topic while somebody looks at it. Needs rclpy."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from jausml.live.ros import QuietNode, message_class
from jausml.live.systems.diagnostics import Status
from jausml.live.systems.ros_values import message_lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.systems.state import TopicName

_DEPTH = 50


class RosDiagnostics:
    """A node without parameters, services or log of its own, which spins in a thread."""

    def __init__(self, take: Callable[[list[Status]], None]) -> None:
        """Does nothing before `start`.

        Args:
            take: Takes the statuses of a message, on another thread.
        """
        self._take = take
        self._latest: deque[Any] = deque(maxlen=1)
        self._watched: Any = None
        self._quiet = QuietNode("top")

    def start(self) -> None:
        """Begins to listen."""
        self._quiet.open(self._listen)
        self._quiet.spin()

    def stop(self) -> None:
        """Leaves ROS."""
        self._quiet.close()

    def watch(self, topic: TopicName) -> str:
        """Subscribes to a topic in the place of the one before.

        Args:
            topic: The topic; what nobody publishes yet is subscribed to as if of a sensor.

        Returns:
            Why it cannot be watched, empty when it is.
        """
        from jausml.runtime.bridge.ends.topics import Qos  # noqa: PLC0415
        from jausml.runtime.bridge.ros.profiles import profile_of, qos_of  # noqa: PLC0415

        self.unwatch()
        kind = message_class(topic.type)
        if kind is None:
            return f"{topic.type} is not installed here"
        node = self._quiet.node
        publishers = node.get_publishers_info_by_topic(topic.name)
        offered = [qos_of(each.qos_profile) for each in publishers]
        # Who asks for little gets what any publisher offers; but what a latched one published
        # before gets only who asks for it.
        is_latched = offered and all(each.durability == "transient_local" for each in offered)
        qos = (
            Qos("reliable", "transient_local", depth=1)
            if is_latched
            else Qos("best_effort", depth=1)
        )
        latest = self._latest

        def note(message: Any) -> None:
            latest.append(message)

        self._watched = node.create_subscription(kind, topic.name, note, profile_of(qos))
        return ""

    def unwatch(self) -> None:
        """Ends the subscription of `watch`."""
        if self._watched is not None:
            self._quiet.node.destroy_subscription(self._watched)
        # What is under way yet goes where nobody looks.
        self._watched, self._latest = None, deque(maxlen=1)

    def latest(self) -> list[str]:
        """Returns the last message of the watched topic as lines; none before the first one."""
        return [line for message in tuple(self._latest) for line in message_lines(message)]

    def _listen(self, node: Any) -> None:
        from diagnostic_msgs.msg import DiagnosticArray  # noqa: PLC0415

        node.create_subscription(DiagnosticArray, "/diagnostics", self._diagnostics, _DEPTH)

    def _diagnostics(self, message: Any) -> None:
        self._take(
            [
                Status(
                    each.level[0],
                    each.name,
                    each.message,
                    each.hardware_id,
                    tuple((pair.key, pair.value) for pair in each.values),
                )
                for each in message.status
            ]
        )
