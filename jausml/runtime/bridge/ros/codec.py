"""Classes of ROS messages, and their serialized form by rclpy."""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

from importlib import import_module
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from ..light_message import installed_class, is_light


def message_class(ros_type: type[Any]) -> type[Any]:
    """Returns the class of rclpy for a ROS type.

    Args:
        ros_type: That class itself, or a light class, whose `TYPE` names the type, e.g.
            `nav_msgs/msg/Odometry`.

    Raises:
        ImportError: ROS has no such package here.
        RosTypeError: The installed type is not that of the light class.
    """
    if is_light(ros_type):
        real: type[Any] = installed_class(ros_type)
        return real
    named: str | None = getattr(ros_type, "TYPE", None)
    if named is None:
        return ros_type
    package, kind, name = named.split("/")
    found: type[Any] = getattr(import_module(f"{package}.{kind}"), name)
    return found


class Codec:
    """Messages of one class of rclpy, as objects and serialized."""

    def __init__(self, ros_type: type[Any]) -> None:
        self.message_class = message_class(ros_type)

    def decode(self, data: bytes) -> Any:
        """Returns the object of a serialized message."""
        return deserialize_message(data, self.message_class)

    def encode(self, message: Any) -> bytes:
        """Returns the serialized form of an object.

        Raises:
            TypeError: It is of another class.
        """
        if not isinstance(message, self.message_class):
            raise TypeError(f"{self.message_class.__name__} expected, not {type(message).__name__}")
        data: bytes = serialize_message(message)
        return data
