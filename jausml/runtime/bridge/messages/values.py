"""Values of ROS messages: how user code sets them, and errors by which a translation gives up."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from ...base.api import JausError

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


class RosLostError(JausError):
    """ROS is gone while the bridge runs: nothing arrives from there any more."""


class RosTypeError(JausError):
    """A ROS type that is not installed as the model has it: its messages cannot be exchanged."""


class AbsentFieldError(JausError):
    """An optional JAUS field that a translation cannot do without."""


class OutOfRangeError(JausError):
    """A value that the target field cannot carry, and that drops the message.

    Attributes:
        field: The field, as the model names it.
        policy: What was to be done: `drop_message`, `error`, or `not_clampable` for a value that
            should be clamped and has no nearest legal value.
    """

    def __init__(self, field: str, reason: str, policy: str = "drop_message") -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field
        self.policy = policy


class StaleJoinError(JausError):
    """A joined topic has delivered nothing, or nothing fresh, and the message needs it."""

    def __init__(self, join: str, reason: str) -> None:
        super().__init__(f"{join}: {reason}")
        self.join = join
