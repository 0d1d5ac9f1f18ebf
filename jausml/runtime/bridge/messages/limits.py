"""Values of target fields: limits, errors, and setters.

Generated translations call the `Limit` that the model names for a field. It returns a legal value
unchanged, after one comparison. The policies differ for other values:

    clamp         the nearest legal value; without one, the message is dropped
    drop_field    None, by which the optional JAUS field is omitted
    drop_message  OutOfRangeError, which drops the message
    error         the same, reported as an error in log and diagnostics
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence, Sized
from typing import Any, ClassVar, Generic, NoReturn, TypeVar

from ...base.api import JausError
from ...conversions import Quaternion, Time

CLAMP = "clamp"
NOT_CLAMPABLE = "not_clampable"
DROP_FIELD = "drop_field"
DROP_MESSAGE = "drop_message"
ERROR = "error"

_LARGEST_SINGLE = 3.4028234663852886e38
_ROUNDING = 2.0**-40  # relative error of a conversion, by which a value may exceed a limit
_SCALED = 0.005  # relative error of scaled integers of 16 bits

Absent = TypeVar("Absent")
T = TypeVar("T")
Number = TypeVar("Number", int, float)
Many = TypeVar("Many", bound="Sized")


def by_name(
    names: Collection[str], keys: Sequence[str], values: Sequence[T], needed: str = ""
) -> list[T | None]:
    """Returns values in the order of names.

    Args:
        names: The names, in order.
        keys: The name of each value; those of sensor_msgs/JointState, for example.
        values: The values; there may be fewer than keys, as ROS allows.
        needed: Field of the values, if none may be missing; it is named in the error.

    Returns:
        A value for each name; None for a missing one.

    Raises:
        AbsentFieldError: A needed value is missing.
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
    """ROS has failed while the bridge runs: no message comes any more."""


class RosTypeError(JausError):
    """A ROS type is not installed as the model has it."""


class AbsentFieldError(JausError):
    """A value that a translation needs is absent in JAUS, or unknown by a marker of ROS."""


class OutOfRangeError(JausError):
    """A value does not fit the target field, so that the message is dropped."""

    def __init__(self, field: str, reason: str, policy: str = "drop_message") -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field  # the field, as the model names it
        # `drop_message`, `error`, or `not_clampable` for one without a nearest legal value.
        self.policy = policy


class StaleJoinError(JausError):
    """A joined message that a translation needs is stale, or none has come."""

    def __init__(self, join: str, reason: str) -> None:
        super().__init__(f"{join}: {reason}")
        self.join = join


class Limit(Generic[Absent]):
    """Makes values fit their target field; each subclass is a policy.

    Without a nearest legal value, or under another policy than `Clamp`, a value that does not fit
    is omitted (None) or raises OutOfRangeError.
    """

    def __init__(self, count: Callable[[str, str, str], None]) -> None:
        self._count = count

    def __call__(self, field: str, value: float, minimum: float, maximum: float) -> float | Absent:
        """Returns a real number within minimum .. maximum, but for errors of rounding."""
        if minimum <= value <= maximum:
            return value
        nearest = _nearest(value, minimum, maximum)
        slack = _ROUNDING * max(abs(minimum), abs(maximum))
        if nearest is not None and minimum - slack <= value <= maximum + slack:
            return nearest
        return self._outside(field, f"{value} is outside {minimum} .. {maximum}", nearest)

    def within(self, field: str, value: Number, minimum: Number, maximum: Number) -> Number:
        """Returns the nearest value within limits of a map, such as a speed, and counts others.

        This does not depend on the policy. Not a number is returned unchanged. A value that exceeds
        a limit only by the rounding of scaled integers is not counted.
        """
        if minimum <= value <= maximum or value != value:
            return value
        slack = _SCALED * (maximum - minimum)
        if not minimum - slack <= value <= maximum + slack:
            self._count(CLAMP, field, f"{value} is outside {minimum} .. {maximum} of the map")
        return min(max(value, minimum), maximum)

    def integer(self, field: str, value: float, minimum: int, maximum: int) -> int | Absent:
        """Returns the nearest integer, which must be within minimum .. maximum."""
        if minimum <= value <= maximum or minimum - 0.5 < value < maximum + 0.5:
            return round(value)
        nearest = _nearest(value, minimum, maximum)
        return self._outside(field, f"{value} is outside {minimum} .. {maximum}", nearest)

    def listed(self, field: str, value: float, ranges: Sequence[tuple[int, int]]) -> int | Absent:
        """Returns an integer of a value set; others have no nearest legal value."""
        if math.isfinite(value):
            number = round(value)
            if any(low <= number <= high for low, high in ranges):
                return number
        return self._outside(field, f"{value} is not in the value set", None)

    def finite(self, field: str, value: float) -> float | Absent:
        """Returns a finite number; others have no nearest legal value."""
        if math.isfinite(value):
            return value
        return self._outside(field, f"{value} is no finite number", None)

    def single(self, field: str, value: float) -> float | Absent:
        """Returns a number of single precision; infinity has no nearest legal value."""
        if math.isinf(value):
            return self._outside(field, f"{value} is no finite number", None)
        return self(field, value, -_LARGEST_SINGLE, _LARGEST_SINGLE)

    def text(self, field: str, value: str, shortest: int, longest: int) -> str | Absent:
        """Returns a text in Latin-1 of a legal length; others have no nearest legal value."""
        if not shortest <= len(value) <= longest:
            reason = f"length {len(value)} is outside {shortest} .. {longest}"
            return self._outside(field, reason, None)
        if not value.isascii() and max(value) > "\xff":
            return self._outside(field, f"{value!r} has characters beyond Latin-1", None)
        return value

    def octets(self, field: str, value: bytes, shortest: int, longest: int) -> bytes | Absent:
        """Returns bytes of a legal length; others have no nearest legal value."""
        if shortest <= len(value) <= longest:
            return value
        reason = f"length {len(value)} is outside {shortest} .. {longest}"
        return self._outside(field, reason, None)

    def sized(self, field: str, values: Many, shortest: int, longest: int) -> Many | Absent:
        """Returns a list of a legal length; others have no nearest legal value."""
        if shortest <= len(values) <= longest:
            return values
        reason = f"{len(values)} elements are not {shortest} .. {longest}"
        return self._outside(field, reason, None)

    def _outside(self, field: str, reason: str, nearest: T | None) -> T | Absent:
        """Applies the policy to a value that does not fit; `nearest` may be None."""
        raise NotImplementedError


class Clamp(Limit[NoReturn]):
    """Uses the nearest legal value; without one, drops the message."""

    def _outside(self, field: str, reason: str, nearest: T | None) -> T:
        if nearest is None:
            raise OutOfRangeError(field, reason, NOT_CLAMPABLE)
        self._count(CLAMP, field, reason)
        return nearest


class DropField(Limit[None]):
    """Omits the field."""

    def __call__(self, field: str, value: float, minimum: float, maximum: float) -> float | None:
        """Returns a real number within minimum .. maximum; None for others."""
        if isinstance(value, float) and math.isnan(value):
            self.unknown(field)
            return None
        return super().__call__(field, value, minimum, maximum)

    def unknown(self, field: str) -> None:
        """Counts a field omitted for not a number, by which ROS marks an unknown value."""
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
    """Returns the limit that a value exceeds; None for not a number."""
    if value < minimum:
        return minimum
    return maximum if value > maximum else None
