"""Errors by which a translation gives up on a message, or a bridge on ROS."""

from __future__ import annotations

from ...base.errors import JausError


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
