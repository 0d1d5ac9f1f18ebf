"""Publishers of serialized messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..ends.topics import Published


class NodePublisher:
    """A publisher for serialized messages.

    Attributes:
        publish: Publishes a serialized message, from any thread: the function of rclpy itself.
    """

    __slots__ = ("_class", "handle", "matched", "publish", "published", "unmatched")

    def __init__(self, handle: Any, ros_class: type[Any], published: Published) -> None:
        self.handle = handle
        self.published = published
        self.publish: Callable[[bytes], None] = handle.publish_raw
        self.matched = 0
        self.unmatched = 0
        self._class = ros_class

    def publish_message(self, message: Any) -> None:
        """Publishes an object of the class of rclpy, from any thread."""
        if not isinstance(message, self._class):
            raise TypeError(f"{self._class.__name__} expected, not {type(message).__name__}")
        self.handle.publish(message)
