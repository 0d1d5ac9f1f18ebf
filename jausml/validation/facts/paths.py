"""Follows the attribute paths of maps through JAUS messages and ROS types."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

from jausml.validation.facts.layouts import (
    attributes,
    class_name,
    integer_range,
    is_group,
    is_time_stamp,
    members,
    resolve,
)

NUMBER = "number"
BOOL = "bool"
TEXT = "text"
OCTETS = "octets"
TIME_STAMP = "TimeStamp"
TIME = "builtin_interfaces/Time"

_STEP = re.compile(r"(?P<name>.*?)(?P<indices>(?:\[[0-9]{1,9}\])*)", re.DOTALL)
_INTEGER_ROS = {
    **{f"int{n}": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)},
    **{f"uint{n}": (0, 2**n - 1) for n in (8, 16, 32, 64)},
    "char": (0, 255),
}


@dataclass(frozen=True, slots=True)
class Attribute:
    """What a path leads to.

    Attributes:
        kind: `number`, `bool`, `text`, `octets`, `TimeStamp`, the full name of a ROS type
            (`geometry_msgs/Quaternion`), or empty for what no assignment can fill or read.
        name: How messages call it, such as `a list` or `geometry_msgs/Pose`.
        integral: Whether a number is an integer.
        lower: Smallest legal number, None for no limit.
        upper: Largest legal number, None for no limit.
        values: Legal integers and ranges of a JAUS value set, empty for no restriction.
        length: Largest number of bytes or characters of a text, None for no limit.
        encoding: Encoding of a text on the wire.
        optional: Whether it is a JAUS field that a message may leave out.
        named: Whether the value set of a number gives single values a meaning.
    """

    kind: str
    name: str
    integral: bool = False
    lower: float | None = None
    upper: float | None = None
    values: tuple[tuple[float, float], ...] = ()
    length: int | None = None
    encoding: str = "utf-8"
    optional: bool = False
    named: bool = False


@dataclass(frozen=True, slots=True)
class PathFault:
    """Why a path leads nowhere."""

    message: str
    hint: str = ""


Found = Attribute | PathFault | None
"""None: what the path leads through was not read, so nothing can be said."""


def jaus_attribute(message: Any, path: str) -> Found:
    """Follows a path from the flattened body of a JAUS message.

    Args:
        message: A `jaus.MessageDef`.
        path: JAUS names joined by dots.
    """
    where = f"message {message.name}"
    fields = attributes(message)
    field: Any = None
    found: Any = None
    for position, step in enumerate(path.split(".")):
        if position:
            if not _has_members(found):
                return PathFault(f"{where} has no attributes")
            fields = list(found.subFields) if class_name(found) == "BitField" else members(found)
        field = next((each for each in fields if each.name == step), None)
        if field is None:
            return _no_attribute(where, step, fields)
        where = f"'{step}'"
        found = field if class_name(field) == "SubField" else resolve(field)
        if found is None:
            return None
    return replace(
        _jaus_value(found),
        optional=class_name(field) != "SubField" and bool(field.optional),
        named=_is_named(found),
    )


def ros_attribute(message_type: Any, path: str) -> Found:
    """Follows a path through a ROS type.

    Args:
        message_type: A `ros.MessageType`.
        path: Field names joined by dots, with `[index]` behind the name of a fixed array.
    """
    current = message_type
    field: Any = None
    indices: list[int] = []
    for position, step in enumerate(path.split(".")):
        if position:
            if class_name(field) != "MessageField":
                return PathFault(f"'{field.name}' is a {field.type.name}, it has no attributes")
            current = field.messageType
            if current is None:
                return None
            if field.arrayKind.name != "single" and not indices:
                return _unindexed(field)
        name, indices = _split(step, [each.name for each in current.fields])
        field = next((each for each in current.fields if each.name == name), None)
        if field is None:
            where = ros_name(current)
            return PathFault(f"{where} has no field '{name}'", _hint(name, current.fields))
        fault = _index_fault(field, indices)
        if fault is not None:
            return fault
    if field.arrayKind.name == "single" or indices:
        return _ros_element(field)
    is_octets = class_name(field) == "PrimitiveField" and field.type.name == "uint8"
    if is_octets and field.arrayKind.name == "unboundedSequence":
        return Attribute(OCTETS, "a sequence of uint8")
    return Attribute("", f"an array of {_ros_element(field).name.removeprefix('a ')}")


def ros_name(message_type: Any) -> str:
    """Returns the full name of a ROS type, such as `geometry_msgs/Pose`."""
    package = message_type.eContainer()
    prefix = f"{package.name}/" if package is not None and package.name else ""
    return f"{prefix}{message_type.name}"


def parse_path(path: str) -> tuple[str, ...]:
    """Returns the steps of a path, indices as steps of their own, to compare paths."""
    return tuple(part for step in path.split(".") for part in re.split(r"(?=\[)", step) if part)


def _split(step: str, known: list[str]) -> tuple[str, list[int]]:
    """Splits `name[3]`; a name that holds brackets itself wins."""
    match = _STEP.fullmatch(step)
    if step in known or match is None:
        return step, []
    return match["name"], [int(each) for each in re.findall("[0-9]+", match["indices"])]


def _hint(name: str, fields: Any) -> str:
    known = [field.name for field in fields if field.name]
    near = get_close_matches(name, known, n=1) or [k for k in known if k.lower() == name.lower()]
    if near:
        return f"did you mean '{near[0]}'?"
    return f"it has {', '.join(known)}" if 0 < len(known) <= 8 else ""


def _has_members(field: Any) -> bool:
    return is_group(field) or class_name(field) == "BitField"


def _no_attribute(where: str, step: str, fields: list[Any]) -> PathFault:
    name, bracket, _ = step.partition("[")
    if bracket and any(field.name == name for field in fields):
        hint = "translate it in the skeleton of the bridge"
        return PathFault(f"elements of '{name}' cannot be named in a map", hint)
    return PathFault(f"{where} has no attribute '{step}'", _hint(step, fields))


def _jaus_value(field: Any) -> Attribute:
    kind = class_name(field)
    if kind == "FixedField":
        return _number(field)
    if kind == "SubField":
        upper = 2 ** (field.highBit - field.lowBit + 1) - 1 if field.highBit >= field.lowBit else 0
        return Attribute(
            NUMBER, "a number", integral=True, lower=0, upper=upper, values=_legal(field.values)
        )
    if kind == "BitField" and is_time_stamp(field):
        return Attribute(TIME_STAMP, "a JAUS TimeStamp")
    if kind == "FixedLengthString":
        return Attribute(TEXT, "text", length=field.length, encoding="latin-1")
    if kind == "VariableLengthString":
        limits = integer_range(field.countType.name)
        length = field.maximumLength or (limits[1] if limits else None)
        return Attribute(TEXT, "text", length=length, encoding="latin-1")
    if kind == "VariableLengthField":
        return Attribute(OCTETS, "a field of octets")
    names = {"BitField": "bit field", "VariableField": "variable field", "List": "list"}
    return Attribute("", f"a {names.get(kind, kind.lower())}")


def _number(field: Any) -> Attribute:
    if field.scale is not None:
        return Attribute(NUMBER, "a number", lower=field.scale.lower, upper=field.scale.upper)
    limits = integer_range(field.type.name)
    if limits is None:
        return Attribute(NUMBER, "a number", values=_legal(field.values))
    lower, upper = limits
    values = _legal(field.values)
    return Attribute(NUMBER, "a number", integral=True, lower=lower, upper=upper, values=values)


def _is_named(field: Any) -> bool:
    values = field.values if class_name(field) in ("FixedField", "SubField") else None
    return values is not None and any(class_name(v) == "EnumeratedValue" for v in values.values)


def _legal(value_set: Any) -> tuple[tuple[float, float], ...]:
    if value_set is None:
        return ()
    return tuple(
        (each.value, each.value)
        if class_name(each) == "EnumeratedValue"
        else (each.lower, each.upper)
        for each in value_set.values
    )


def _index_fault(field: Any, indices: list[int]) -> PathFault | None:
    if not indices:
        return None
    if field.arrayKind.name == "single":
        return PathFault(f"'{field.name}' is not an array, it has no [{indices[0]}]")
    if field.arrayKind.name != "fixedArray":
        return PathFault(
            f"'{field.name}' is a sequence whose length is not known beforehand",
            "fill or read it in the skeleton of the bridge",
        )
    if len(indices) > 1:
        return PathFault(f"'{field.name}' has one dimension")
    if indices[0] >= field.arraySize:
        size = field.arraySize
        return PathFault(f"'{field.name}' has {size} elements, counted from 0: no [{indices[0]}]")
    return None


def _unindexed(field: Any) -> PathFault:
    hint = f"name one element: {field.name}[0]" if field.arrayKind.name == "fixedArray" else ""
    return PathFault(f"'{field.name}' is an array", hint)


def _ros_element(field: Any) -> Attribute:
    if class_name(field) == "MessageField":
        name = ros_name(field.messageType) if field.messageType is not None else "a message"
        return Attribute(name, f"a {name}")
    if field.type.name in ("string", "wstring"):
        return Attribute(TEXT, "text", length=field.stringBound or None)
    return primitive(field.type.name)


def primitive(kind: str) -> Attribute:
    """Returns what a value of a ROS primitive type is.

    Args:
        kind: Name of the type, such as `float64`.
    """
    if kind == "bool":
        return Attribute(BOOL, "a bool")
    if kind in ("string", "wstring"):
        return Attribute(TEXT, "text")
    if kind in _INTEGER_ROS:
        lower, upper = _INTEGER_ROS[kind]
        return Attribute(NUMBER, "a number", integral=True, lower=lower, upper=upper)
    if kind in ("float32", "float64"):
        limit = 3.4028234663852886e38 if kind == "float32" else None
        return Attribute(NUMBER, "a number", lower=-limit if limit else None, upper=limit)
    return Attribute("", f"a {kind}")
