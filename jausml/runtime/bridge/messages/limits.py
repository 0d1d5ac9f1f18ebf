"""Values of ROS messages: setters, errors, and limits of what their target field cannot carry.

Generated translations call the limit that the model names for the field. All of them return a value
that fits as it is, which is the usual case and costs one comparison. They differ in the others:

    clamp         the nearest legal value; the message is dropped when there is none
    drop_field    None, so that the optional JAUS field is left out
    drop_message  OutOfRangeError, which drops the message
    error         the same, which is also an error in log and diagnostics
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence, Sized
from typing import Any, ClassVar, Generic, NoReturn, TypeVar

from ...base.api import JausError
from ...conversions import Quaternion, Time


def by_name(
    names: Collection[str], keys: Sequence[str], values: Sequence[T], needed: str = ""
) -> list[T | None]:
    """Returns values in the order of names.

    Args:
        names: The names, in the order that is wanted.
        keys: The name of each value; those of sensor_msgs/JointState, for example.
        values: The values; a value less than there are keys is missing, as ROS allows.
        needed: What the values are, where none may be missing.

    Returns:
        One for each name; None where no key is that name.

    Raises:
        AbsentFieldError: One is missing and needed; it is named.
    """
    values_by_name = dict(zip(keys, values, strict=False))
    missing = [name for name in names if name not in values_by_name] if needed else ()
    if missing:
        missing_names = ", ".join(map(ascii, missing))
        raise AbsentFieldError(f"{needed}: {missing_names} is not among the names")
    return [values_by_name.get(name) for name in names]


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
    """A value that a translation cannot do without: left out by JAUS, or unknown by a marker."""


class OutOfRangeError(JausError):
    """A value that the target field cannot carry, and that drops the message."""

    def __init__(self, field: str, reason: str, policy: str = "drop_message") -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field  # the field, as the model names it
        # What was to be done: `drop_message`, `error`, or `not_clampable` for a value that should
        # be clamped and has no nearest legal value.
        self.policy = policy


class StaleJoinError(JausError):
    """A joined topic has delivered nothing, or nothing fresh, and the message needs it."""

    def __init__(self, join: str, reason: str) -> None:
        super().__init__(f"{join}: {reason}")
        self.join = join


CLAMP = "clamp"
NOT_CLAMPABLE = "not_clampable"
DROP_FIELD = "drop_field"
DROP_MESSAGE = "drop_message"
ERROR = "error"

_LARGEST_SINGLE = 3.4028234663852886e38
# A conversion in floating point may miss a limit by the last bits of its factors: this part of it.
_ROUNDING = 2.0**-40
# Scaled integers of 16 bits miss a value by so little, as a part of the range of the map.
_SCALED = 0.005

Absent = TypeVar("Absent")
T = TypeVar("T")
Number = TypeVar("Number", int, float)
Many = TypeVar("Many", bound="Sized")


class Limit(Generic[Absent]):
    """Keeps values within what their target field can carry; the subclasses are the policies."""

    def __init__(self, count: Callable[[str, str, str], None]) -> None:
        self._count = count

    def __call__(self, field: str, value: float, minimum: float, maximum: float) -> float | Absent:
        """Returns a real number within minimum .. maximum."""
        if minimum <= value <= maximum:
            return value
        nearest = _nearest(value, minimum, maximum)
        slack = _ROUNDING * max(abs(minimum), abs(maximum))
        if nearest is not None and minimum - slack <= value <= maximum + slack:
            return nearest
        return self._outside(field, f"{value} is outside {minimum} .. {maximum}", nearest)

    def within(self, field: str, value: Number, minimum: Number, maximum: Number) -> Number:
        """Returns what a map limits on purpose, such as a speed, and counts what is limited.

        Whatever the policy is, the value becomes the nearest one; not a number stays so. What is
        beyond an end by as little as scaled integers are rounded is not counted.
        """
        if minimum <= value <= maximum or value != value:
            return value
        slack = _SCALED * (maximum - minimum)
        if not minimum - slack <= value <= maximum + slack:
            self._count(CLAMP, field, f"{value} is outside {minimum} .. {maximum} of the map")
        return min(max(value, minimum), maximum)

    def integer(self, field: str, value: float, minimum: int, maximum: int) -> int | Absent:
        """Returns the nearest integer within minimum .. maximum, as the call itself does.

        A value that is rounded to an end is within.
        """
        if minimum <= value <= maximum or minimum - 0.5 < value < maximum + 0.5:
            return round(value)
        nearest = _nearest(value, minimum, maximum)
        return self._outside(field, f"{value} is outside {minimum} .. {maximum}", nearest)

    def listed(self, field: str, value: float, ranges: Sequence[tuple[int, int]]) -> int | Absent:
        """Returns an integer of a value set; others have no nearest one: each has a meaning."""
        if math.isfinite(value):
            number = round(value)
            if any(low <= number <= high for low, high in ranges):
                return number
        return self._outside(field, f"{value} is not in the value set", None)

    def finite(self, field: str, value: float) -> float | Absent:
        """Returns a number that is not infinite; not a number and the infinite have no nearest."""
        if math.isfinite(value):
            return value
        return self._outside(field, f"{value} is no finite number", None)

    def single(self, field: str, value: float) -> float | Absent:
        """Returns a number that fits into single precision; the infinite have no nearest."""
        if math.isinf(value):
            return self._outside(field, f"{value} is no finite number", None)
        return self(field, value, -_LARGEST_SINGLE, _LARGEST_SINGLE)

    def text(self, field: str, value: str, shortest: int, longest: int) -> str | Absent:
        """Returns a text of Latin-1 characters; one that does not fit has no nearest."""
        if not shortest <= len(value) <= longest:
            reason = f"length {len(value)} is outside {shortest} .. {longest}"
            return self._outside(field, reason, None)
        if not value.isascii() and max(value) > "\xff":
            return self._outside(field, f"{value!r} has characters beyond Latin-1", None)
        return value

    def octets(self, field: str, value: bytes, shortest: int, longest: int) -> bytes | Absent:
        """Returns bytes of a legal length; others have no nearest."""
        if shortest <= len(value) <= longest:
            return value
        reason = f"length {len(value)} is outside {shortest} .. {longest}"
        return self._outside(field, reason, None)

    def sized(self, field: str, values: Many, shortest: int, longest: int) -> Many | Absent:
        """Returns a list of a legal length; others have no nearest."""
        if shortest <= len(values) <= longest:
            return values
        reason = f"{len(values)} elements are not {shortest} .. {longest}"
        return self._outside(field, reason, None)

    def _outside(self, field: str, reason: str, nearest: T | None) -> T | Absent:
        """Does with a value that does not fit what the policy says; None is no nearest value."""
        raise NotImplementedError


class Clamp(Limit[NoReturn]):
    """Uses the nearest legal value; what has none drops the message."""

    def _outside(self, field: str, reason: str, nearest: T | None) -> T:
        if nearest is None:
            raise OutOfRangeError(field, reason, NOT_CLAMPABLE)
        self._count(CLAMP, field, reason)
        return nearest


class DropField(Limit[None]):
    """Leaves the field out."""

    def __call__(self, field: str, value: float, minimum: float, maximum: float) -> float | None:
        """Returns a real number within minimum .. maximum; None for others."""
        if isinstance(value, float) and math.isnan(value):
            self.unknown(field)
            return None
        return super().__call__(field, value, minimum, maximum)

    def unknown(self, field: str) -> None:
        """Counts a value that is no number: ROS marks so what is unknown, in every message."""
        self._count(DROP_FIELD, field, "not a number")

    def _outside(self, field: str, reason: str, nearest: T | None) -> None:  # noqa: ARG002
        self._count(DROP_FIELD, field, reason)


class DropMessage(Limit[NoReturn]):
    """Drops the message."""

    policy: ClassVar[str] = DROP_MESSAGE

    def _outside(self, field: str, reason: str, nearest: T | None) -> NoReturn:  # noqa: ARG002
        raise OutOfRangeError(field, reason, self.policy)


class Error(DropMessage):
    """Drops the message and reports an error."""

    policy = ERROR


def _nearest(value: float, minimum: Number, maximum: Number) -> Number | None:
    """Returns the end beyond which a value lies; not a number lies beyond none."""
    if value < minimum:
        return minimum
    return maximum if value > maximum else None
