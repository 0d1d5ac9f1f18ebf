"""Fields of ROS messages, found by paths."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from jausml.language.attributes.expressions import variables
from jausml.language.cdr import short_name
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.paths.markers import VALUE, Mark, marks_at
from jausml.language.semantics.paths.ros_paths import (
    RosPlace,
    fields_by_name,
    is_sequence,
    named_constants,
)
from jausml.language.semantics.paths.scopes import parse_path
from jausml.language.semantics.subject import remembered
from jausml_generators.bridge.translation.places import (
    Condition,
    HasValue,
    Local,
    Longer,
    MarkerOperand,
    PathError,
    Place,
    Requirement,
)

_STEP = re.compile(r"(?P<name>[A-Za-z]\w*)(?:\[(?P<index>\d+)\])?")
_NO_OWNER = Place("")


@dataclass(frozen=True)
class RosStart:
    """Where paths start.

    Attributes:
        root: The variable that holds the message or the element.
        type: Its `ros.MessageType`; None for an element without fields.
        field: The `ros.Field` of which it is an element.
        label: What stands before the path in counters and errors.
        owner: The message that has the field.
    """

    root: str | Local
    type: ros.MessageType | None
    field: ros.Field | None = None
    label: str = ""
    owner: Place = _NO_OWNER


@dataclass(frozen=True)
class RosField:
    """The end of a path.

    Attributes:
        path: The path as counters and errors name it, e.g. `pose.covariance[7]`.
        type: Primitive type (`float64`) or full name of a message type
            (`geometry_msgs/Quaternion`).
        place: Where the value stands.
        bound: Most characters of a string; 0 when nothing limits it.
        counts: Fewest and most elements of a whole array; None when nothing limits them.
        message_type: The `ros.MessageType` of the end or of the elements of the array; None for
            primitive types.
        field: The `ros.Field` at the end; None for a whole message.
        constants: Names and values of the constants of the message that has the field.
        elements: The elements of sequences on the way, which may not be there.
        conditions: What must hold for a value to be there: long sequences, and no markers.
        owner: The message that has the field.
    """

    path: str
    type: str
    is_array: bool
    place: Place
    bound: int
    counts: tuple[int, int] | None
    message_type: ros.MessageType | None
    field: ros.Field | None
    constants: tuple[tuple[str, str], ...]
    elements: tuple[tuple[Longer, ros.Field], ...]
    conditions: tuple[Requirement, ...]
    owner: Place


def ros_field(message_type: ros.MessageType, path: str, start: RosStart | None = None) -> RosField:
    """Follows a path through the fields of a modelled message type.

    Args:
        message_type: The `ros.MessageType` of the message.
        path: Field names joined by dots; `name[i]` is an element of an array, `.` the start.
        start: Where the path starts; the message `source` when it is not given.

    Raises:
        PathError: The path does not lead to a field.
    """
    return _end((message_type, path, start or RosStart("source", message_type)))


@remembered
def _end(asked: tuple[ros.MessageType, str, RosStart]) -> RosField:
    """Follows a path that many ask for: checks of a map go the same ones for each of its chains."""
    message_type, path, begin = asked
    current, field, is_array = begin.type, begin.field, False
    holder, place = message_type, Place(begin.root)
    owner = begin.owner
    elements: list[tuple[Longer, ros.Field]] = []
    conditions: list[Condition] = []
    for step in [] if path == "." else path.split("."):
        match = _STEP.fullmatch(step)
        if current is None or is_array or match is None:
            whole = short_name(begin.type or message_type)
            raise PathError(f"'{path}' does not lead to a field of {whole}")
        field = fields_by_name(current).get(match["name"])
        if field is None:
            raise PathError(f"{short_name(current)} has no field '{match['name']}' ('{path}')")
        holder, owner, place = current, place, place.at(match["name"])
        if match["index"] is not None:
            if is_sequence(field):
                longer = Longer(place, int(match["index"]))
                elements.append((longer, field))
                conditions.append(longer)
            place = place.at(int(match["index"]))
        is_array = field.arrayKind.name != "single" and match["index"] is None
        # Markers that speak of elements ask each element, others ask the field as a whole.
        marks = marks_at(field, is_element=not is_array)
        conditions += markers(marks, field, place, owner)
        current = field.messageType if isinstance(field, ros.MessageField) else None
    primitive = field if current is None and isinstance(field, ros.PrimitiveField) else None
    return RosField(
        path=".".join(segment for segment in (begin.label, path) if segment not in ("", ".")),
        type=primitive.type.name if primitive is not None else short_name(current or message_type),
        is_array=is_array,
        place=place,
        bound=primitive.stringBound if primitive is not None else 0,
        counts=_counts(field) if is_array and field is not None else None,
        message_type=current,
        field=field,
        constants=named_constants(holder),
        elements=tuple(elements),
        conditions=tuple(conditions),
        owner=owner,
    )


def markers(
    marks: Iterable[Mark], field: ros.Field, place: Place, owner: Place
) -> Iterator[HasValue]:
    """Yields the conditions under which no marker says of a field that it has no value.

    Args:
        place: The field, or an element of an array.
        owner: The message that has the field.
    """
    for mark in marks:
        names = variables(mark.condition)
        operands = tuple((name, _operand(field, place, owner, name)) for name in names)
        yield HasValue(place, mark.condition, operands)


def _operand(field: ros.Field, place: Place, owner: Place, name: str) -> MarkerOperand:
    """Returns the operand that a name in a marker stands for."""
    holder, operand_place = field.eContainer(), place
    if name != VALUE and isinstance(holder, ros.MessageType):
        end = RosPlace(type=holder).follow(name)
        if not isinstance(end, RosPlace) or end.field is None:
            raise PathError(f"'{name}' does not lead to a number of {short_name(holder)}")
        parts = parse_path(name)
        steps = [int(part[1:-1]) if part.startswith("[") else part for part in parts]
        if end.is_count:
            return MarkerOperand(owner.at(*steps[:-1]), "")
        field, operand_place = end.field, owner.at(*steps)
    return MarkerOperand(
        operand_place, field.type.name if isinstance(field, ros.PrimitiveField) else "int32"
    )


def _counts(field: ros.Field) -> tuple[int, int] | None:
    size = field.arraySize
    kinds = {"fixedArray": (size, size), "boundedSequence": (0, size)}
    return kinds.get(field.arrayKind.name)
