"""Values on their way between conversions and ROS messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ...conversions import Quaternion, Time


T = TypeVar("T")


def by_name(names: Iterable[str], keys: Sequence[str], values: Sequence[T]) -> list[T | None]:
    """Returns values in the order of names.

    Args:
        names: The names, in the order that is wanted.
        keys: The name of each value; those of sensor_msgs/JointState, for example.
        values: The values; a value less than there are keys is missing, as ROS allows.

    Returns:
        One for each name; None where no key is that name.
    """
    found = dict(zip(keys, values, strict=False))
    return [found.get(name) for name in names]


def set_quaternion(target: Any, value: Quaternion) -> None:
    """Stores an orientation into a geometry_msgs/Quaternion."""
    target.x, target.y, target.z, target.w = value


def set_time(target: Any, value: Time) -> None:
    """Stores an instant into a builtin_interfaces/Time."""
    target.sec, target.nanosec = value
