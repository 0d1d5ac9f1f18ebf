"""Follows attribute paths through the bodies of JAUS messages."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Any

from jausml.validation.facts.attributes import (
    LIST,
    NUMBER,
    OCTETS,
    TEXT,
    TIME_STAMP,
    UNSTATED,
    Attribute,
    PathFault,
    nearest_name,
)
from jausml.validation.facts.layouts import (
    attributes,
    class_name,
    integer_range,
    is_group,
    is_time_stamp,
    members,
    resolve,
)

_LIST_NAMES = {"BitField": "bit field", "VariableField": "variable field"}
_CARRIERS = frozenset({"VariableLengthField", "VariableFormatField"})


@dataclass(frozen=True, slots=True)
class JausPlace:
    """A place in a JAUS message, from which paths go on.

    Attributes:
        where: How messages name it.
        message: The `jaus.MessageDef` for its whole body, else None.
        field: What stands there, references resolved: a field, a sub-field or an alternative.
        units: Unit of the field or of those around it.
        frame: Frame of the field or of those around it.
        label: Name of the innermost member that has a name of its own.
        optional: Whether the field itself may be left out.
    """

    where: str
    message: Any = None
    field: Any = None
    units: str = ""
    frame: str = UNSTATED
    label: str = ""
    optional: bool = False

    def follow(self, path: str) -> JausPlace | PathFault | None:
        """Returns the place that a path leads to; None when a part of it was not read.

        Args:
            path: Names joined by dots, `.` for the place itself.
        """
        place: JausPlace | PathFault | None = self
        for step in [] if path == "." else path.split("."):
            if not isinstance(place, JausPlace):
                return place
            place = place.step(step)
        return place

    def element(self) -> JausPlace | None:
        """Returns an element of the list or array at this place."""
        return self._inside(self.field.element, f"an element of {self.where}")

    def members(self) -> list[Any] | None:
        """Returns what can be named here; None for a place without members."""
        if self.message is not None:
            return attributes(self.message)
        kind = class_name(self.field)
        if kind == "BitField":
            return list(self.field.subFields)
        if kind == "VariableField":
            return list(self.field.alternatives)
        if kind == "Variant":
            return list(self.field.options)
        return members(self.field) if is_group(self.field) else None

    def attribute(self) -> Attribute:
        """Returns what an assignment finds here."""
        if self.message is not None:
            return Attribute("", "a message")
        return replace(
            _value(self.field),
            optional=self.optional,
            units=self.units,
            frame=self.frame,
            label=self.label,
            field=self.field,
        )

    def step(self, step: str) -> JausPlace | PathFault | None:
        """Returns the place behind one name, indices included."""
        fields = self.members()
        if fields is None:
            hint = f"name one element: {self.label}[0]" if self._is_many() else ""
            return PathFault(f"{self.where} has no attributes", hint)
        name, indices = _split(step, fields)
        field = next((each for each in fields if each.name == name), None)
        if field is None:
            message = f"{self.where} has no attribute '{step}'"
            return PathFault(message, nearest_name(name, fields))
        place = self._inside(field, f"'{step}'")
        return place.indexed(indices) if place is not None else None

    def _inside(self, field: Any, where: str) -> JausPlace | None:
        if field is None:
            return None
        kind = class_name(field)
        found = field if kind in ("SubField", "Alternative") else resolve(field)
        if found is None:
            return None
        is_field = kind not in ("SubField", "Alternative")
        frames = [field.frame.name, found.frame.name] if is_field else []
        return JausPlace(
            where,
            field=found,
            units=(getattr(found, "units", None) or "") or self.units,
            frame=next((each for each in frames if each != UNSTATED), self.frame),
            label=self.label if kind == "Alternative" else field.name or self.label,
            optional=bool(is_field and field.optional),
        )

    def indexed(self, indices: list[int]) -> JausPlace | PathFault | None:
        """Returns the element that indices name."""
        if not indices:
            return self
        kind = class_name(self.field)
        if kind == "List":
            if len(indices) > 1:
                return PathFault(f"{self.where} has one dimension")
            limits = [_most_elements(self.field)]
        elif kind == "Array":
            limits = list(self.field.dimensions)
            if len(indices) != len(limits):
                return PathFault(f"{self.where} has {len(limits)} dimensions")
        else:
            return PathFault(f"{self.where} is no list and no array")
        for index, limit in zip(indices, limits, strict=True):
            if index >= limit:
                message = f"'{self.label}' has at most {limit} elements, counted from 0"
                return PathFault(f"{message}: no [{index}]")
        element = self.element()
        return replace(element, where=self.where, optional=False) if element else None

    def _is_many(self) -> bool:
        return class_name(self.field) in ("List", "Array")


def message_place(message: Any) -> JausPlace:
    """Returns the place from which the paths of a JAUS message start.

    Args:
        message: A `jaus.MessageDef`.
    """
    frame = UNSTATED
    body = resolve(message.body)
    if body is not None and is_group(body):
        stated = [each.frame.name for each in (message.body, body)]
        frame = next((each for each in stated if each != UNSTATED), UNSTATED)
    return JausPlace(f"message {message.name}", message=message, frame=frame)


def _split(step: str, fields: list[Any]) -> tuple[str, list[int]]:
    """Splits `name[3]`; a name that holds brackets itself wins."""
    match = re.fullmatch(r"(.*?)((?:\[[0-9]{1,9}\])+)", step, re.DOTALL)
    if match is None or any(each.name == step for each in fields):
        return step, []
    return match[1], [int(each) for each in re.findall("[0-9]+", match[2])]


def _most_elements(field: Any) -> int:
    limits = integer_range(field.countType.name)
    return int(field.maximumCount) or (limits[1] if limits else 0)


def _value(field: Any) -> Attribute:
    kind = class_name(field)
    if kind in ("FixedField", "Alternative"):
        return _number(field)
    if kind == "SubField":
        upper = 2 ** (field.highBit - field.lowBit + 1) - 1 if field.highBit >= field.lowBit else 0
        return _integer(field, 0, upper)
    if kind == "BitField" and is_time_stamp(field):
        return Attribute(TIME_STAMP, "a JAUS TimeStamp")
    if kind == "FixedLengthString":
        return Attribute(TEXT, "text", length=field.length, encoding="latin-1")
    if kind == "VariableLengthString":
        limits = integer_range(field.countType.name)
        length = field.maximumLength or (limits[1] if limits else None)
        return Attribute(TEXT, "text", length=length, encoding="latin-1")
    if kind == "VariableLengthField":
        return Attribute(OCTETS, "a field of octets", carries=True)
    if kind == "List":
        return Attribute(LIST, "a list")
    if kind == "Array":
        return Attribute(LIST, "an array", count=math.prod(field.dimensions))
    name = _LIST_NAMES.get(kind, re.sub("(?<=[a-z])(?=[A-Z])", " ", kind).lower())
    return Attribute("", f"a {name}", carries=kind in _CARRIERS)


def _number(field: Any) -> Attribute:
    limits = integer_range(field.type.name)
    if field.scale is not None:
        lower, upper = field.scale.lower, field.scale.upper
        step = (upper - lower) / limits[1] if limits else None
        return Attribute(NUMBER, "a number", lower=lower, upper=upper, step=step)
    if limits is not None:
        return _integer(field, *limits)
    is_single = field.type.name == "float32"
    return Attribute(NUMBER, "a number", values=_legal(field.values), is_single=is_single)


def _integer(field: Any, lower: int, upper: int) -> Attribute:
    listed = field.values.values if field.values is not None else ()
    named = [each for each in listed if class_name(each) == "EnumeratedValue"]
    return Attribute(
        NUMBER,
        "a number",
        integral=True,
        lower=lower,
        upper=upper,
        step=1,
        values=_legal(field.values),
        named=bool(named),
        constants=tuple((each.name, str(each.value)) for each in named if each.name),
    )


def _legal(value_set: Any) -> tuple[tuple[float, float], ...]:
    if value_set is None:
        return ()
    return tuple(
        (each.value, each.value)
        if class_name(each) == "EnumeratedValue"
        else (each.lower, each.upper)
        for each in value_set.values
    )
