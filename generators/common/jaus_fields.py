"""Paths into JAUS message bodies: what stands at the end of `Velocity_X` or `TimeStamp.Day`."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generators.common.fields import Bits, Blob, Fixed
from jausml.generators.common.members import Member
from jausml.generators.common.nested import BitFieldClass, SubField
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
        limits: Least and greatest value of a number, or fewest and most characters of a text or
            bytes of octets; infinite when nothing limits it.
        brought: Least and greatest integer that the wire can bring, legal or not.
        values: Legal ranges of an integer with named values or gaps; empty for others.
        is_scaled: Whether a real stands on the wire as an integer, and so is finite.
        is_optional: Whether the end itself may be left out.
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
    brought: Limits | None = None
    values: tuple[tuple[int, int], ...] = ()
    is_scaled: bool = False
    is_optional: bool = False
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
        is_optional=isinstance(end, Member) and end.is_optional,
        units=end.units if isinstance(end, Member) else "",
        **_facts(message, end),
    )


def _facts(message: MessageView, end: Member | SubField) -> dict[str, Any]:
    value = end.value
    if isinstance(value, Bits):
        return {
            "kind": BITS,
            "class_name": value.python_type,
            "sub_fields": _sub_fields(message, value.python_type),
        }
    if isinstance(value, Fixed):
        kind = _KINDS[value.python_type]
        brought = _brought(end, value) if kind == INTEGER else None
        return {
            "kind": kind,
            "limits": _limits(value, kind, brought),
            "brought": brought,
            "values": _values(value, is_named=bool(end.enumeration)),
            "is_scaled": value.scale is not None,
        }
    if isinstance(value, Blob):
        return {"kind": TEXT if value.is_text else OCTETS, "limits": (value.lower, value.upper)}
    return {"kind": OTHER}


def _sub_fields(message: MessageView, path: str) -> tuple[str, ...]:
    return next(
        tuple(sub.attribute for sub in item.sub_fields)
        for item in message.nested
        if isinstance(item, BitFieldClass) and item.path == path
    )


def _brought(end: Member | SubField, value: Fixed) -> Limits:
    if isinstance(end, SubField):
        return 0, end.mask
    bits = 8 * value.size
    return (0, 2**bits - 1) if value.format.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _limits(value: Fixed, kind: str, brought: Limits | None) -> Limits:
    if value.scale is not None:
        return value.scale
    if value.check == "integer":
        return int(value.limits[0]), int(value.limits[1])
    if value.check == "real":
        return float(value.limits[0]), float(value.limits[1])
    if brought is not None:
        return brought
    return (0, value.size) if kind == TEXT else _UNLIMITED


def _values(value: Fixed, *, is_named: bool) -> tuple[tuple[int, int], ...]:
    if value.check == "one_of":
        ranges: tuple[tuple[int, int], ...] = ast.literal_eval(value.limits[0])
        return ranges
    if value.check == "integer" and is_named:
        return ((int(value.limits[0]), int(value.limits[1])),)
    return ()
