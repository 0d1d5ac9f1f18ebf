"""The parts of rclpy below its public interface that a bridge uses.

Subscriptions, publishers and events are handles of rclpy's extension module, which the loop or a
wait set serves. That takes a third of the time of the public classes, and the executor need not
check each of them whenever it wakes up. A new version of rclpy may break it.
"""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

from typing import Any

from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message

from ..light_message import installed, installed_class, is_light
from ..messages.limits import RosLostError
from .values import checked

internals: Any = rclpy_implementation  # the extension module of rclpy
_HANDLE = ("destroy_when_not_in_use", "pointer")

# Classes of the extension module, and their attributes that are used.
NEEDED: dict[str, tuple[str, ...]] = {
    "EventHandle": (*_HANDLE, "take_event"),
    "GuardCondition": (*_HANDLE, "trigger_guard_condition"),
    "Publisher": (*_HANDLE, "publish", "publish_raw", "wait_for_all_acked"),
    "Service": (
        *_HANDLE,
        *("configure_introspection", "service_send_response", "service_take_request"),
    ),
    "Subscription": (*_HANDLE, "take_message"),
    "WaitSet": (
        *("add_event", "add_guard_condition", "add_service", "add_subscription", "clear_entities"),
        *("destroy_when_not_in_use", "get_ready_entities", "is_ready", "wait"),
    ),
}
_EXECUTOR = ("_make_handler", "_spin_once_impl", "_take_waitable", "wait_for_ready_callbacks")


def require_internals(node: Any) -> None:
    """Raises RosLostError for an rclpy without an attribute that the bridge uses."""
    needed = [(getattr(internals, name, None), name, parts) for name, parts in NEEDED.items()]
    needed += [
        (Duration, "Duration", ("get_c_duration",)),
        (QoSProfile, "QoSProfile", ("get_c_qos_profile",)),
        (Node, "Node", ("handle", "resolve_topic_name")),
        (node, "node", ("_parameter_overrides",)),
        (SingleThreadedExecutor, "SingleThreadedExecutor", _EXECUTOR),
    ]
    lacking = [
        f"{name}.{part}"
        for owner, name, parts in needed
        for part in parts
        if not hasattr(owner, part)
    ]
    if lacking:
        raise RosLostError(f"this rclpy lacks {', '.join(lacking)}, which bridges rely on")


def message_class(ros_type: type[Any]) -> type[Any]:
    """Returns the class of rclpy for a ROS type, which may be that class, or a light class.

    Raises:
        ImportError: The type is not installed.
        RosTypeError: The installed type differs from the light class, or there is none.
    """
    if is_light(ros_type):
        real: type[Any] = installed_class(ros_type)
        return real
    named: str | None = getattr(ros_type, "TYPE", None)
    if named is None:
        return ros_type
    rclpy_class: type[Any] = installed(named)
    return rclpy_class


class Codec:
    """Serializes and deserializes messages of one class of rclpy."""

    def __init__(self, ros_type: type[Any]) -> None:
        self.message_class = message_class(ros_type)
        # The first message with arrays imports numpy: not later, while messages pass.
        self.message_class()

    def decode(self, data: bytes) -> Any:
        """Returns the object of a serialized message."""
        return deserialize_message(data, self.message_class)

    def encode(self, message: Any) -> bytes:
        """Returns an object, serialized; raises TypeError or EncodeError for an unfit one."""
        if not isinstance(message, self.message_class):
            raise TypeError(f"{self.message_class.__name__} expected, not {type(message).__name__}")
        data: bytes = serialize_message(checked(message))
        return data
