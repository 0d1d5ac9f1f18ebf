"""Values on their way from one message to the other, and what keeps them within their target.

A value carries its kind, so that the store at the end knows what is left to do: a real for a ROS
float, a limit for a scaled JAUS field, and so on. Text of the model becomes a constant here, or
nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from jausml.language.interfaces.definitions import INTEGER_RANGES
from jausml.language.wire import REALS
from jausml_generators.bridge.translation.expressions import (
    BITS,
    BOOLEAN,
    INTEGER,
    OCTETS,
    QUATERNION,
    REAL,
    TEXT,
    TIME,
    Cast,
    Constant,
    Expression,
    Limit,
    New,
    Ranges,
)
from jausml_generators.bridge.translation.places import Requirement
from jausml_generators.bridge.translation.policies import NO_POLICY, Policy
from jausml_generators.bridge.translation.ros_fields import RosField
from jausml_generators.python.codec.jaus_fields import JausField, Limits

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

_SINGLE, _DOUBLE = ((-real_type.largest, real_type.largest) for real_type in REALS.values())
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
class Value:
    """A value on its way to the target.

    Attributes:
        conditions: What must hold for the value to be there.
        units: Unit of the source, or words about units; empty when unknown.
        known: All integers that it can be; empty when they are not known.
    """

    expression: Expression
    conditions: tuple[Requirement, ...] = ()
    units: str = ""
    limits: tuple[float, float] | None = None
    policy: Policy = NO_POLICY
    listed: tuple[tuple[str, str], ...] = ()
    known: tuple[int, ...] = ()
    is_computed: bool = False

    @property
    def kind(self) -> str:
        """Kind of the value."""
        return self.expression.kind


def ros_kind(target: RosField) -> str:
    """Returns the kind of value that a ROS field holds."""
    if target.is_array:
        return OCTETS if target.type in {"uint8", "byte"} else f"array of {target.type}"
    # Names of message types are kinds of their own.
    return _ROS_KINDS.get(target.type, target.type)


# ---------------------------------------------------------------- fitted to the target


def fitted_to_ros(value: Value, target: RosField) -> Expression:
    """Returns a value as one of a ROS field."""
    wanted = ros_kind(target)
    if wanted == INTEGER and value.kind in NUMBERS:
        # What measures is a real, has a unit, or is converted.
        is_identifier = value.kind == INTEGER and not (value.units or value.is_computed)
        policy = value.policy.of_identifiers if is_identifier else value.policy
        return _integer(value, policy, target.path, INTEGER_RANGES[target.type])
    if wanted == REAL and value.kind in {INTEGER, BOOLEAN}:
        return Cast(value.expression, REAL)
    # A double may be beyond the range of float32, where it would become infinite.
    if wanted == value.kind == REAL and target.type == "float32":
        return _single(value, target.path)
    if wanted == value.kind == TEXT and value.policy.owner and target.bound:
        return value.policy.limit("text", value.expression, target.path, (0, target.bound))
    if wanted == BOOLEAN and value.kind in {INTEGER, REAL}:
        return Cast(value.expression, BOOLEAN)
    if wanted == value.kind:
        return value.expression
    raise AssignmentError(f"{value.kind} does not fit {target.path} ({target.type})")


def fitted_to_jaus(value: Value, target: JausField) -> Expression:
    """Returns a value as one of a JAUS field."""
    if target.kind == INTEGER and value.kind in NUMBERS:
        if target.values:
            return _listed(value, target)
        policy = value.policy.of_identifiers if target.is_identifier else value.policy
        return _integer(value, policy, target.path, target.limits)
    if target.kind == REAL and value.kind in NUMBERS:
        expression = value.expression if value.kind == REAL else Cast(value.expression, REAL)
        # Limits of the source that lie within those of the target make a check needless.
        if value.limits is None or not _within(value.limits, target.limits):
            return real(value.policy, expression, target.path, target.limits)
        return expression
    if target.kind == BITS and value.kind == BITS:
        return New(target.class_name, (value.expression,), is_spread=True)
    if target.kind == value.kind == TEXT:
        return value.policy.limit("text", value.expression, target.path, target.limits)
    if target.kind == value.kind == OCTETS:
        return _octets(value, target)
    raise AssignmentError(f"{value.kind} does not fit {target.path}")


def real(policy: Policy, value: Expression, path: str, limits: Limits) -> Expression:
    """Returns a real within limits."""
    if limits == _DOUBLE:
        return policy.limit("finite", value, path)
    if limits == _SINGLE:
        return policy.limit("single", value, path)
    return policy.limit("", value, path, limits)


def _integer(value: Value, policy: Policy, path: str, limits: Limits) -> Expression:
    if value.kind == INTEGER and value.limits is not None and _within(value.limits, limits):
        return value.expression
    return policy.limit("integer", value.expression, path, (int(limits[0]), int(limits[1])))


def _listed(value: Value, target: JausField) -> Expression:
    legal = (any(low <= integer <= high for low, high in target.values) for integer in value.known)
    if value.known and all(legal):
        return value.expression
    policy, ranges = value.policy, Ranges(target.values)
    return Limit(policy.owner, policy.name, "listed", target.path, value.expression, (ranges,))


def _single(value: Value, path: str) -> Expression:
    if value.limits is not None and _within(value.limits, _SINGLE):
        return value.expression
    return value.policy.limit("single", value.expression, path)


def _octets(value: Value, target: JausField) -> Expression:
    octets = Cast(value.expression, OCTETS)
    lower, upper = target.limits
    # The length field of 32 bits takes any octets that fit in memory.
    if lower == 0 and upper >= _COUNTED_BY_32_BITS:
        return octets
    return value.policy.limit("octets", octets, target.path, target.limits)


def _within(inner: Limits, outer: Limits) -> bool:
    return outer[0] <= inner[0] <= inner[1] <= outer[1]


# ---------------------------------------------------------------- constants


def constant(
    kind: str, text: str, limits: Limits, place: str, listed: Sequence[tuple[str, str]] = ()
) -> Constant:
    """Returns a text of the model as a constant of a kind.

    Args:
        text: The constant, or the name of one.
    """
    # Of several values of one name the first counts.
    text = dict(reversed(listed)).get(text, text)
    if kind in {REAL, INTEGER}:
        try:
            value = float(text) if kind == REAL else int(text, 0)
        except ValueError as error:
            raise AssignmentError(f"{text!r} is no number ({place})") from error
        # Some ROS fields say by NaN that a value is unknown; where there is a range, none does.
        is_unknown = math.isnan(value) and limits == UNLIMITED
        if not limits[0] <= value <= limits[1] and not is_unknown:
            raise AssignmentError(f"{text!r} is out of the range of {place}")
        return Constant(value, kind)
    if kind == BOOLEAN and text in {"true", "false"}:
        return Constant(text == "true", kind)
    if kind == TEXT:
        return Constant(text, kind)
    raise AssignmentError(f"{text!r} does not fit {place}")


def ros_constant(target: RosField, text: str) -> Value:
    """Returns a constant as the type of a ROS field needs it."""
    kind = ros_kind(target)
    limits = INTEGER_RANGES.get(target.type, UNLIMITED)
    value = constant(kind, text, limits, target.path, target.constants)
    return Value(value, limits=limits)
