"""Paths into ROS messages: what stands at the end of `pose.pose.position.x`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

_STEP = re.compile(r"(?P<name>[A-Za-z]\w*)(?:\[(?P<index>\d+)\])?")

INTEGER_RANGES = {
    f"{sign}int{bits}": ((0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1))
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
} | {"byte": (0, 255), "char": (0, 255)}


class PathError(ValueError):
    """A path that leads nowhere."""


@dataclass(frozen=True)
class RosField:
    """The end of a path.

    Attributes:
        path: The path as it stands in Python, e.g. `pose.covariance[7]`.
        type: Primitive type (`float64`) or full name of a message type
            (`geometry_msgs/Quaternion`).
        is_array: True when the end is a whole array.
        bound: Most characters of a string; 0 when nothing limits it.
    """

    path: str
    type: str
    is_array: bool
    bound: int = 0


def ros_field(message_type: Any, path: str) -> RosField:
    """Follows a path through the fields of a modelled message type.

    Args:
        message_type: The `ros.MessageType`.
        path: Field names joined by dots; `name[i]` is an element of an array.

    Raises:
        PathError: There is no such field, or the path goes on behind a value.
    """
    current = message_type
    kind, is_array, bound = full_name(message_type), False, 0
    for step in path.split("."):
        found = _STEP.fullmatch(step)
        if current is None or is_array or found is None:
            raise PathError(f"'{path}' does not lead to a field of {full_name(message_type)}")
        field = _field_named(current, found["name"])
        if field is None:
            raise PathError(f"{full_name(current)} has no field '{found['name']}' ('{path}')")
        is_array = field.arrayKind.name != "single" and found["index"] is None
        if field.eClass.name == "MessageField":
            current, kind = field.messageType, full_name(field.messageType)
        else:
            current, kind, bound = None, str(field.type.name), int(field.stringBound)
    return RosField(path, kind, is_array, bound)


def full_name(message_type: Any) -> str:
    """Returns package and name, e.g. `geometry_msgs/Quaternion`."""
    return f"{message_type.eContainer().name}/{message_type.name}"


def _field_named(message_type: Any, name: str) -> Any:
    return next((field for field in message_type.fields if field.name == name), None)
