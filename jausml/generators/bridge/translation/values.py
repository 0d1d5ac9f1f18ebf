"""Values on their way from one message to the other, and what keeps them within their target.

A value carries its kind, so that the store at the end knows what is left to do: a real for a ROS
float, a limit for a scaled JAUS field, and so on. Text of the model becomes a literal here, or
nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_literal, python_string
from jausml.generators.bridge.translation.ros_fields import INTEGER_RANGES
from jausml.generators.python.codec.jaus_fields import BITS, INTEGER, OCTETS, REAL, TEXT, Limits
from jausml.generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.generators.bridge.translation.ros_fields import RosField
    from jausml.generators.python.codec.jaus_fields import Condition, JausField

BOOLEAN, QUATERNION, TIME = "boolean", "quaternion", "time"
NUMBERS = {REAL, INTEGER, BOOLEAN}
PYTHON_TYPES = {
    REAL: "float",
    INTEGER: "int",
    BOOLEAN: "bool",
    TEXT: "str",
    OCTETS: "bytes",
    QUATERNION: "conversions.Quaternion",
    TIME: "conversions.Time",
    BITS: "conversions.TimeStamp",
}
"""Types of the kinds of values as conversions see them."""

INPUT_TYPES = {
    **PYTHON_TYPES,
    QUATERNION: "conversions.QuaternionLike",
    TIME: "conversions.TimeLike",
}
"""The same for what conversions are given: messages of ROS have attributes of these names."""

UNLIMITED = (-math.inf, math.inf)

_SINGLE = (-3.4028234663852886e38, 3.4028234663852886e38)
_DOUBLE = (-1.7976931348623157e308, 1.7976931348623157e308)
_COUNTED_BY_32_BITS = 2**32 - 1
_ROS_KINDS = {
    "geometry_msgs/Quaternion": QUATERNION,
    "builtin_interfaces/Time": TIME,
    "bool": BOOLEAN,
    "string": TEXT,
    "wstring": TEXT,
    "float32": REAL,
    "float64": REAL,
    **dict.fromkeys(INTEGER_RANGES, INTEGER),
}


class AssignmentError(ValueError):
    """An assignment whose value does not fit its target."""


@dataclass(frozen=True)
class Limit:
    """What keeps values within their targets.

    Attributes:
        path: Its Python path, e.g. `self.speed.clamp`; empty for values that need none.
        drops_field: Whether it answers None for what does not fit.
        identifiers: Python path of the limit of identifiers and counts; empty for the same one.
    """

    path: str = ""
    drops_field: bool = False
    identifiers: str = ""

    @property
    def of_identifiers(self) -> Limit:
        """The limit of integers that measure nothing: the next one means something else."""
        return replace(self, path=self.identifiers) if self.identifiers else self


NO_LIMIT = Limit()
"""The limit of constants, and of values that are only asked whether they are there."""


@dataclass(frozen=True)
class Fitted:
    """A value as its target takes it.

    Attributes:
        code: Python expression.
        can_be_none: Whether it is None where the value does not fit.
    """

    code: str
    can_be_none: bool = False


@dataclass(frozen=True)
class Value:
    """A value on its way to the target.

    Attributes:
        code: Python expression.
        kind: Kind of the value.
        conditions: What must hold for the value to be there.
        units: Unit of the source, or words about units; empty when unknown.
        limits: Least and greatest value of a number that is not converted, when they are known.
        limit: What keeps the value within its target.
        listed: Names and values of the numbers that the source names.
        known: All integers that it can be; empty when they are not known.
        is_computed: Whether asking for it again would compute it again.
    """

    code: str
    kind: str
    conditions: tuple[Condition, ...] = ()
    units: str = ""
    limits: tuple[float, float] | None = None
    limit: Limit = NO_LIMIT
    listed: tuple[tuple[str, str], ...] = ()
    known: tuple[int, ...] = ()
    is_computed: bool = False


def ros_kind(target: RosField) -> str:
    """Returns the kind of value that a ROS field holds."""
    if target.is_array:
        return OCTETS if target.type in {"uint8", "byte"} else f"array of {target.type}"
    return _ROS_KINDS.get(target.type, target.type)


# ---------------------------------------------------------------- fitted to the target


def fitted_to_ros(value: Value, target: RosField) -> Fitted:
    """Returns a value as one of a ROS field.

    Raises:
        AssignmentError: The kinds do not go together.
    """
    wanted = ros_kind(target)
    if wanted == INTEGER and value.kind in NUMBERS:
        # What measures is a real, has a unit, or is converted.
        is_identifier = value.kind == INTEGER and not (value.units or value.is_computed)
        limit = value.limit.of_identifiers if is_identifier else value.limit
        return _integer(value, limit, target.path, INTEGER_RANGES[target.type])
    if wanted == REAL and value.kind in {INTEGER, BOOLEAN}:
        return Fitted(call("float", value.code))
    if wanted == value.kind == REAL and target.type == "float32":
        return _single(value, target.path)
    if wanted == value.kind == TEXT and value.limit.path and target.bound:
        return limited(value.limit, "text", value.code, target.path, (0, target.bound))
    if wanted == BOOLEAN and value.kind in {INTEGER, REAL}:
        return Fitted(call("bool", value.code))
    if wanted == value.kind:
        return Fitted(value.code)
    raise AssignmentError(f"{value.kind} does not fit {target.path} ({target.type})")


def fitted_to_jaus(value: Value, target: JausField) -> Fitted:
    """Returns a value as one of a JAUS field.

    Raises:
        AssignmentError: The kinds do not go together.
    """
    if target.kind == INTEGER and value.kind in NUMBERS:
        if target.values:
            return _listed(value, target)
        limit = value.limit.of_identifiers if target.is_identifier else value.limit
        return _integer(value, limit, target.path, target.limits)
    if target.kind == REAL and value.kind in NUMBERS:
        code = value.code if value.kind == REAL else call("float", value.code)
        if value.limits is None or not _within(value.limits, target.limits):
            return real(value.limit, code, target.path, target.limits)
        return Fitted(code)
    if target.kind == BITS and value.kind == BITS:
        return Fitted(call(target.class_name, f"*{value.code}"))
    if target.kind == value.kind == TEXT:
        return limited(value.limit, "text", value.code, target.path, target.limits)
    if target.kind == value.kind == OCTETS:
        return _octets(value, target)
    raise AssignmentError(f"{value.kind} does not fit {target.path}")


def real(limit: Limit, code: str, name: str, limits: Limits) -> Fitted:
    """Returns a real within limits.

    Args:
        limit: What keeps it there.
        code: The real.
        name: Path of the field, for counters.
        limits: Least and greatest value.
    """
    if limits == _DOUBLE:
        return limited(limit, "finite", code, name, ())
    if limits == _SINGLE:
        return limited(limit, "single", code, name, ())
    return limited(limit, "", code, name, limits)


def limited(limit: Limit, method: str, code: str, name: str, limits: tuple[float, ...]) -> Fitted:
    """Returns a value within limits.

    Args:
        limit: What keeps it there.
        method: How; empty for numbers between two others.
        code: The value.
        name: Path of the field, for counters.
        limits: The limits.
    """
    function = f"{limit.path}.{method}" if method else limit.path
    arguments = (python_string(name), code, *map(python_literal, limits))
    return Fitted(call(function, *arguments), can_be_none=limit.drops_field)


def _integer(value: Value, limit: Limit, name: str, limits: Limits) -> Fitted:
    if value.kind == INTEGER and value.limits is not None and _within(value.limits, limits):
        return Fitted(value.code)
    ends = (int(limits[0]), int(limits[1]))
    return limited(limit, "integer", value.code, name, ends)


def _listed(value: Value, target: JausField) -> Fitted:
    legal = (any(low <= each <= high for low, high in target.values) for each in value.known)
    if value.known and all(legal):
        return Fitted(value.code)
    arguments = (python_string(target.path), value.code, repr(target.values))
    code = call(f"{value.limit.path}.listed", *arguments)
    return Fitted(code, can_be_none=value.limit.drops_field)


def _single(value: Value, name: str) -> Fitted:
    if value.limits is not None and _within(value.limits, _SINGLE):
        return Fitted(value.code)
    return limited(value.limit, "single", value.code, name, ())


def _octets(value: Value, target: JausField) -> Fitted:
    code = call("bytes", value.code)
    lower, upper = target.limits
    if lower == 0 and upper >= _COUNTED_BY_32_BITS:
        return Fitted(code)
    return limited(value.limit, "octets", code, target.path, target.limits)


def _within(inner: Limits, outer: Limits) -> bool:
    return outer[0] <= inner[0] <= inner[1] <= outer[1]


# ---------------------------------------------------------------- constants


def constant(
    kind: str,
    text: str,
    limits: Limits,
    place: str,
    listed: Sequence[tuple[str, str]] = (),
) -> str:
    """Returns a text of the model as a literal of a kind.

    Args:
        kind: Kind of the target.
        text: The constant, or the name of one.
        limits: Least and greatest number.
        place: Path of the target, for errors.
        listed: Names and values of constants.

    Raises:
        AssignmentError: The text is no such value.
    """
    # Of several values of one name the first counts.
    text = dict(reversed(listed)).get(text, text)
    if kind in {REAL, INTEGER}:
        try:
            number = float(text) if kind == REAL else int(text, 0)
        except ValueError as error:
            raise AssignmentError(f"{text!a} is no number ({place})") from error
        is_unknown = math.isnan(number) and limits == UNLIMITED
        if not limits[0] <= number <= limits[1] and not is_unknown:
            raise AssignmentError(f"{text!a} is out of the range of {place}")
        return python_literal(number)
    if kind == BOOLEAN and text in {"true", "false"}:
        return python_literal(text == "true")
    if kind == TEXT:
        return python_string(text)
    raise AssignmentError(f"{text!a} does not fit {place}")


def ros_constant(target: RosField, text: str) -> Value:
    """Returns a constant as the type of a ROS field needs it.

    Raises:
        AssignmentError: The text is no such value.
    """
    kind = ros_kind(target)
    limits = INTEGER_RANGES.get(target.type, UNLIMITED)
    code = constant(kind, text, limits, target.path, target.constants)
    return Value(code, kind, limits=limits)
