"""Listener to `/diagnostics`, and to one topic while a user looks at it. Needs rclpy."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

from jausml.live.ros.node import QuietNode, message_class
from jausml.live.systems.folding import DiagnosticStatus
from jausml.live.systems.state import TopicName

_DEPTH = 50

MOST_ELEMENTS = 8  # of a shown array

LONGEST_VALUE = 200  # characters of a shown text


class RosDiagnostics:
    """A node that spins in a thread, and has no parameters, services or log."""

    def __init__(self, take: Callable[[list[DiagnosticStatus]], None]) -> None:
        """Listens from `start` on (`take`: is called with the statuses of each message)."""
        self._take = take
        self._latest: deque[Any] = deque(maxlen=1)
        self._watched: Any = None
        self._quiet = QuietNode("top")

    def start(self) -> None:
        """Begins to listen (`RosFault`: there is no ROS)."""
        self._quiet.open(self._listen)
        self._quiet.spin()

    def stop(self) -> None:
        """Leaves ROS."""
        self._quiet.close()

    def watch(self, topic: TopicName) -> str:
        """Subscribes to a topic instead of the former one.

        Returns:
            The reason why it cannot be watched; empty when it is.
        """
        from jausml.runtime.bridge.ends.topics import Qos  # noqa: PLC0415
        from jausml.runtime.bridge.ros.parameters import profile_of, qos_of  # noqa: PLC0415

        self.unwatch()
        kind = message_class(topic.type)
        if kind is None:
            return f"{topic.type} is not installed here"
        node = self._quiet.node
        publishers = node.get_publishers_info_by_topic(topic.name)
        offered = [qos_of(publisher.qos_profile) for publisher in publishers]
        # A best effort subscription matches any publisher, but only a latched one gets the earlier
        # message of latched publishers.
        is_latched = offered and all(profile.durability == "transient_local" for profile in offered)
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
        # A late message still goes to the former deque.
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
                DiagnosticStatus(
                    status.level[0],
                    status.name,
                    status.message,
                    status.hardware_id,
                    tuple((pair.key, pair.value) for pair in status.values),
                )
                for status in message.status
            ]
        )


def message_lines(message: Any, indent: str = "") -> Iterator[str]:
    """Yields a line for each field of a message, with the fields of inner messages below."""
    for name in message.get_fields_and_field_types():
        value = getattr(message, name)
        if _is_message(value):
            yield f"{indent}{name}:"
            yield from message_lines(value, indent + "  ")
        elif _is_array(value):
            yield from _array_lines(name, value, indent)
        else:
            yield f"{indent}{name}: {_shown(value)}"


def _array_lines(name: str, values: Any, indent: str) -> Iterator[str]:
    first = [values[index] for index in range(min(len(values), MOST_ELEMENTS))]
    more = f", … ({len(values)} in all)" if len(values) > len(first) else ""
    if not first or not _is_message(first[0]):
        yield f"{indent}{name}: [{', '.join(map(_shown, first))}{more}]"
        return
    for index, element in enumerate(first):
        yield f"{indent}{name}[{index}]:"
        yield from message_lines(element, indent + "  ")
    if more:
        yield f"{indent}{name}: {more.removeprefix(', ')}"


def _is_message(value: Any) -> bool:
    return hasattr(value, "get_fields_and_field_types")


def _is_array(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, (str, bytes))


def _shown(value: Any) -> str:
    text = str(value) if isinstance(value, (bool, int, float, str)) else repr(value)
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 1] + "…"
