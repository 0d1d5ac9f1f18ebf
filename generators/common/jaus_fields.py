"""Paths into JAUS message bodies: what stands at the end of `Velocity_X` or `TimeStamp.Day`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generators.common.fields import Bits, Blob, Fixed
from jausml.generators.common.members import Member
from jausml.generators.common.nested import BitFieldClass
from jausml.generators.common.ros_fields import PathError
from jausml.generators.common.values import PartValue

if TYPE_CHECKING:
    from jausml.generators.common.messages import MessageView

REAL, INTEGER, TEXT, OCTETS, BITS, OTHER = "real", "integer", "text", "octets", "bits", "other"

Limits = tuple[float, float]
_KINDS = {"float": REAL, "int": INTEGER, "str": TEXT, "bytes": OCTETS}
_UNLIMITED = (-math.inf, math.inf)


@dataclass(frozen=True)
class JausField:
    """The end of a path.

    Attributes:
        path: The path as the model writes it.
        attribute: The path as it stands in Python, e.g. `pose_rec.x`.
        may_be_absent: Python paths on the way, and the end, that are None when absent.
        containers: Python path and class of each nested container on the way.
        kind: `real`, `integer`, `text`, `octets`, `bits` or `other`.
        limits: Least and greatest value of a number; infinite when nothing limits it.
        units: Unit of the value; empty when the model has none.
        class_name: Class of a bit field, e.g. `ReportLocalPose.TimeStamp`.
        sub_fields: Python names of the parts of a bit field.
    """

    path: str
    attribute: str
    may_be_absent: tuple[str, ...]
    containers: tuple[tuple[str, str], ...]
    kind: str
    limits: Limits = _UNLIMITED
    units: str = ""
    class_name: str = ""
    sub_fields: tuple[str, ...] = ()


def jaus_field(message: MessageView, path: str) -> JausField:
    """Follows a path through the body of a message.

    Args:
        message: The message.
        path: JAUS names joined by dots, relative to the flattened body.

    Raises:
        PathError: There is no such field.
    """
    steps = message.find(path)
    if not steps:
        raise PathError(f"{message.jaus_name} has no field '{path}'")
    attributes: list[str] = []
    absent: list[str] = []
    containers: list[tuple[str, str]] = []
    for step in steps:
        attributes.append(step.attribute)
        place = ".".join(attributes)
        if isinstance(step, Member) and step.is_optional:
            absent.append(place)
        if step is not steps[-1] and isinstance(step.value, (Bits, PartValue)):
            containers.append((place, step.value.python_type))
    end = steps[-1]
    return JausField(
        path,
        ".".join(attributes),
        tuple(absent),
        tuple(containers),
        units=end.units if isinstance(end, Member) else "",
        **_facts(message, end.value),
    )


def _facts(message: MessageView, value: object) -> dict[str, Any]:
    if isinstance(value, Bits):
        return {
            "kind": BITS,
            "class_name": value.python_type,
            "sub_fields": _sub_fields(message, value.python_type),
        }
    if isinstance(value, Fixed):
        kind = _KINDS[value.python_type]
        return {"kind": kind, "limits": _limits(value, kind)}
    return (
        {"kind": TEXT if value.is_text else OCTETS} if isinstance(value, Blob) else {"kind": OTHER}
    )


def _sub_fields(message: MessageView, path: str) -> tuple[str, ...]:
    return next(
        tuple(sub.attribute for sub in item.sub_fields)
        for item in message.nested
        if isinstance(item, BitFieldClass) and item.path == path
    )


def _limits(value: Fixed, kind: str) -> Limits:
    if value.scale is not None:
        return value.scale
    if value.check in {"integer", "real"}:
        return float(value.limits[0]), float(value.limits[1])
    if kind == INTEGER:
        bits = 8 * value.size
        if value.format.isupper():
            return 0, 2**bits - 1
        return -(2 ** (bits - 1)), 2 ** (bits - 1) - 1
    return _UNLIMITED
