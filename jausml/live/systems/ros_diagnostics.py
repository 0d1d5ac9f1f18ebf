"""Listens to `/diagnostics`, and to one topic while somebody looks at it. Needs rclpy."""

from __future__ import annotations

import importlib
import os
from collections import deque
from threading import Thread
from typing import TYPE_CHECKING, Any

from jausml.live.systems.diagnostics import Status
from jausml.live.systems.ros_values import message_lines
from jausml.semantics.names import is_identifier

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.systems.state import TopicName

_DEPTH = 50


class RosFault(Exception):  # noqa: N818 - a state of the computer, not a fault of ours
    """ROS cannot be used here."""


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
        self._context: Any = None
        self._node: Any = None
        self._executor: Any = None
        self._thread: Thread | None = None

    def start(self) -> None:
        """Begins to listen.

        Raises:
            RosFault: rclpy is missing or does not work.
        """
        try:
            import rclpy  # noqa: PLC0415 - it is on robots, not everywhere
            from diagnostic_msgs.msg import DiagnosticArray  # noqa: PLC0415
            from rclpy.context import Context  # noqa: PLC0415
            from rclpy.executors import SingleThreadedExecutor  # noqa: PLC0415
        except ImportError as error:
            raise RosFault(f"no ROS here: {error}") from error
        try:
            self._context = Context()
            rclpy.init(context=self._context, args=[])
            self._node = rclpy.create_node(
                f"jausml_top_{os.getpid()}",
                context=self._context,
                start_parameter_services=False,
                enable_rosout=False,
            )
            self._node.create_subscription(
                DiagnosticArray, "/diagnostics", self._diagnostics, _DEPTH
            )
            self._executor = SingleThreadedExecutor(context=self._context)
            self._executor.add_node(self._node)
        except (RuntimeError, OSError) as error:
            raise RosFault(f"ROS does not work here: {error}") from error
        self._thread = Thread(target=self._spin, name="diagnostics", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Leaves ROS."""
        if self._thread is None:
            return
        self._executor.shutdown()
        self._thread.join()
        self._node.destroy_node()
        self._context.try_shutdown()
        self._thread = None

    def watch(self, topic: TopicName) -> str:
        """Subscribes to a topic in the place of the one before.

        Args:
            topic: The topic; what nobody publishes yet is subscribed to as if of a sensor.

        Returns:
            Why it cannot be watched, empty when it is.
        """
        from jausml.runtime.bridge.ros_profiles import profile_of, qos_of  # noqa: PLC0415
        from jausml.runtime.bridge.topics import Qos  # noqa: PLC0415

        self.unwatch()
        kind = _message_class(topic.type)
        if kind is None:
            return f"{topic.type} is not installed here"
        publishers = self._node.get_publishers_info_by_topic(topic.name)
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

        self._watched = self._node.create_subscription(kind, topic.name, note, profile_of(qos))
        return ""

    def unwatch(self) -> None:
        """Ends the subscription of `watch`."""
        if self._watched is not None:
            self._node.destroy_subscription(self._watched)
        # What is under way yet goes where nobody looks.
        self._watched, self._latest = None, deque(maxlen=1)

    def latest(self) -> list[str]:
        """Returns the last message of the watched topic as lines; none before the first one."""
        return [line for message in tuple(self._latest) for line in message_lines(message)]

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

    def _spin(self) -> None:
        from rclpy.executors import ExternalShutdownException  # noqa: PLC0415

        try:
            self._executor.spin()
        except ExternalShutdownException:
            return


def _message_class(name: str) -> Any:
    """Returns the class of a message type, None when it is not installed."""
    package, _, kind = name.partition("/msg/")
    if not (is_identifier(package) and is_identifier(kind)):
        return None
    try:
        return getattr(importlib.import_module(f"{package}.msg"), kind, None)
    except ImportError:
        return None
