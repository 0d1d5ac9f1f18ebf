"""Markers of ROS fields: conditions that say that a field has no value, as JAUS leaves it out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

from jausml.language.attributes import expressions
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.subject import remembered

VALUE = "value"
"""How a condition calls the field itself, or an element of an array."""

UNLIMITED = "unlimited"


@dataclass(frozen=True)
class Mark:
    """A marker as it is read.

    Attributes:
        condition: What holds where the field has no value.
        is_of_elements: Whether it is one of each element of an array.
    """

    marker: ros.Marker
    condition: expressions.Expression
    is_of_elements: bool

    @property
    def is_unlimited(self) -> bool:
        """Whether its meaning is that the quantity has no limit, which is more than no value."""
        return self.marker.meaning.name == UNLIMITED


@remembered
def marks_of(field: ros.Field) -> tuple[Mark, ...]:
    """Returns the markers of a field; of a condition that cannot be read a rule tells."""
    return tuple(mark for marker in field.markers if (mark := _mark(field, marker)) is not None)


def _mark(field: ros.Field, marker: ros.Marker) -> Mark | None:
    try:
        condition = expressions.parse_expression(marker.condition or "")
    except expressions.ExpressionError:
        return None
    is_array = field.arrayKind.name != "single"
    return Mark(marker, condition, is_array and VALUE in expressions.variables(condition))


def marks_at(field: ros.Field, *, is_element: bool) -> tuple[Mark, ...]:
    """Returns the markers that count where a path names a field, or an element of an array."""
    return tuple(mark for mark in marks_of(field) if is_element or not mark.is_of_elements)


def in_words(marker: ros.Marker) -> str:
    """Returns a marker in words: meaning, condition, its own value if any, and its source."""
    written = f", written {marker.value}" if marker.value else ""
    stated = f" ({marker.stated})" if marker.stated else ""
    return f"{marker.meaning.name} if {marker.condition}{written}{stated}"


@remembered
def unknown(field: ros.Field) -> str | None:
    """Returns the text that a field without a value gets.

    Returns:
        The text of the model; empty where the default of the field says it, and None where the
        field alone cannot. That nothing limits a quantity is said by a default, and never written.
    """
    marks = marks_of(field)
    if field.arrayKind.name not in ("single", "fixedArray"):
        # What says that a sequence is empty says nothing of its elements.
        marks = tuple(mark for mark in marks if mark.is_of_elements)
    said = (str(mark.marker.value or "") for mark in marks if not mark.is_unlimited)
    written = next(filter(None, said), None) if isinstance(field, ros.PrimitiveField) else None
    if written is None and any(_is_said_by_default(field, mark) for mark in marks):
        return ""
    return written


def _is_said_by_default(field: ros.Field, mark: Mark) -> bool:
    owner = field.eContainer()
    values: dict[str, float] = {}
    for name in expressions.variables(mark.condition):
        path = str(field.name) if name == VALUE else name
        value = number_as_made(owner, path) if isinstance(owner, ros.MessageType) else None
        if value is None:
            return False
        values[name] = value
    return is_said(mark.condition, values)


def number_as_made(owner: ros.MessageType, path: str) -> float | None:
    """Returns the number at a path of a message as it is made; None where there is none."""
    name, _, rest = path.partition(".")
    name, _, index = name.partition("[")
    field = next((candidate for candidate in owner.fields if candidate.name == name), None)
    if isinstance(field, ros.MessageField):
        return number_as_made(field.messageType, rest) if field.messageType is not None else None
    if not isinstance(field, ros.PrimitiveField):
        return None
    try:
        # ROS makes numbers without a default 0.
        value = json.loads(field.defaultValue or "0")
        if isinstance(value, list):
            value = value[int(index.rstrip("]") or 0)]
        return float(value)
    except (ValueError, TypeError, LookupError):
        return None


def is_said(condition: expressions.Expression, values: Mapping[str, float]) -> bool:
    """Tells whether a marker holds for some numbers, by its names for them."""
    try:
        return expressions.evaluate(condition, values) != 0.0
    except (expressions.EvaluationError, KeyError):
        return False
