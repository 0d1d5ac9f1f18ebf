"""Stores the results of conversions into ROS messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .conversions import Quaternion, Time


def set_quaternion(target: Any, value: Quaternion) -> None:
    """Stores an orientation into a geometry_msgs/Quaternion."""
    target.x, target.y, target.z, target.w = value


def set_time(target: Any, value: Time) -> None:
    """Stores an instant into a builtin_interfaces/Time."""
    target.sec, target.nanosec = value
