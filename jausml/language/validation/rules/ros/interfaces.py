"""Rules about interfaces of ROS: how they are named, their constants, defaults and sizes."""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Iterator
from dataclasses import replace

from jausml.language.attributes.expressions import ExpressionError, parse_expression, variables
from jausml.language.interfaces.definitions import (
    CONSTANT_NAME,
    FIELD_NAME,
    RESERVED,
    TEXTS,
    FieldType,
    ValueTextError,
    write_value,
)
from jausml.language.metamodel.classes import ros
from jausml.language.model.values import show
from jausml.language.semantics.names import DEVICES
from jausml.language.semantics.paths.attributes import (
    BOOL,
    NUMBER,
    NUMBERS,
    OCTETS,
    PathFault,
    constant_fault,
    primitive,
)
from jausml.language.semantics.paths.markers import VALUE, is_said
from jausml.language.semantics.paths.ros_paths import RosPlace, is_sequence
from jausml.language.semantics.ros_types import excesses
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, rule

# The parts of services and actions are named SetBool_Request and the like.
_TYPE_NAME = re.compile("[A-Z][A-Za-z0-9]*(_Request|_Response|_Goal|_Result|_Feedback)?")
_LOWER_CASE_HINT = "lower case, words joined by one underscore"
_TYPE = ("name", "type", "stringBound", "arrayKind", "arraySize")
_LARGEST_ARRAY = 4 << 20
_SPELLINGS: tuple[tuple[type[ros.NamedElement], re.Pattern[str], str, str], ...] = (
    (ros.InterfacePackage, FIELD_NAME, "package", _LOWER_CASE_HINT),
    (ros.MessageType, _TYPE_NAME, "type", "CamelCase"),
    (ros.ServiceType, _TYPE_NAME, "type", "CamelCase"),
    (ros.ActionType, _TYPE_NAME, "type", "CamelCase"),
    (ros.Field, FIELD_NAME, "field", _LOWER_CASE_HINT),
    (ros.Constant, CONSTANT_NAME, "constant", "UPPER_CASE"),
)
"""How names are spelt: of which elements, by which pattern, what they are called, and a hint."""


@rule(
    "JML406", "illegal ROS interface", kinds=tuple(kind for kind, *_ in _SPELLINGS), needs=("name",)
)
def interfaces(_: Subject, element: ros.NamedElement) -> Iterator[Finding]:
    """Interface packages, types, fields and constants are named as ROS 2 demands.

    Packages and fields are of lower case with single underscores, types are in CamelCase, constants
    of upper case. A field is no keyword of Python, C or C++: rosidl would write code that cannot be
    imported or compiled. Nor is it from_cdr or to_cdr, as bridges call what reads and writes a
    message. A fixed array and a bounded sequence have a size of 1 or more; a fixed array no more
    than 4194304, for each message holds all of it. A range goes from a minimum to a larger maximum,
    both of the type.

    Bad: `<messages name="wheel_speeds">` with a field named frontLeft

    Good: `<messages name="WheelSpeeds">` with a field named front_left
    """
    spelling = next(candidate for candidate in _SPELLINGS if isinstance(element, candidate[0]))
    pattern, noun, hint = spelling[1:]
    name = element.name
    if name is not None and not pattern.fullmatch(name):
        yield Finding(element, f"{name!r} is no {noun} name", "name", hint)
    elif noun == "type" and (name or "").lower() in DEVICES:
        message = f"type name '{name}' is a device name on Windows"
        yield Finding(element, message, "name", "its file would have that name")


@interfaces.also(ros.Field, needs=("name", "arrayKind"))
def _fields(_: Subject, field: ros.Field) -> Iterator[Finding]:
    if keyword.iskeyword(field.name or ""):
        yield Finding(field, f"field name '{field.name}' is a keyword of Python", "name")
    elif field.name in RESERVED:
        message = f"field name '{field.name}' is a word of C or C++"
        yield Finding(field, message, "name", "its type could not be compiled")
    elif field.name in ("from_cdr", "to_cdr"):
        message = f"field name '{field.name}' is that of a method of generated messages"
        yield Finding(field, message, "name")
    array, size = field.arrayKind.name, field.arraySize
    is_too_large = array == "fixedArray" and size > _LARGEST_ARRAY
    if is_too_large or (array in ("fixedArray", "boundedSequence") and size < 1):
        message = f"'{field.name}' is a {array} of size {size}"
        yield Finding(field, message, "arraySize")


@interfaces.also(ros.PrimitiveField, needs=("name", "type", "minimum", "maximum"))
def _ranges(_: Subject, field: ros.PrimitiveField) -> Iterator[Finding]:
    able = primitive(field.type.name)
    lower = -math.inf if able.lower is None else able.lower
    upper = math.inf if able.upper is None else able.upper
    is_stated = able.kind == NUMBER and (field.minimum, field.maximum) != (0, 0)
    if is_stated and not lower <= field.minimum < field.maximum <= upper:
        message = f"'{field.name}' has the range {field.minimum:g}..{field.maximum:g}"
        yield Finding(field, f"{message}, which is none of {field.type.name}", "minimum")


@rule("JML408", "impossible constant", kinds=ros.Constant, needs=("name", "type"))
def constant_values(_: Subject, constant: ros.Constant) -> Iterator[Finding]:
    """The value of a constant of an interface is of its type.

    Bad: `<constants name="LIMIT" type="uint8" value="256"/>`

    Good: `<constants name="LIMIT" type="uint8" value="255"/>`
    """
    # A byte is no number to rclpy, but its constants are.
    kind = "uint8" if constant.type.name == "byte" else constant.type.name
    fault = constant_fault(constant.value or "", primitive(kind))
    if not fault and kind in TEXTS:
        fault = _text_fault(constant.value or "", kind)
    if fault:
        message = f"value {constant.value!r} of constant '{constant.name}' {fault}"
        yield Finding(constant, message, "value")


@rule("JML410", "impossible default or marker", kinds=ros.PrimitiveField, needs=_TYPE)
def default_values(_: Subject, field: ros.PrimitiveField) -> Iterator[Finding]:
    """A default has the type of its field, and can be written in an interface definition.

    Arrays are written as JSON. A text contains no # and no line end, which would end it in a
    definition, and no =, which would turn the field into a constant. The condition of a marker is
    an expression over `value` and numbers of its message type, which are not in sequences; its
    value is one of the field, and makes the condition true.

    Bad: `<fields xsi:type="ros:PrimitiveField" name="gain" type="uint8" defaultValue="256"/>`

    Good: `<fields xsi:type="ros:PrimitiveField" name="gain" type="uint8" defaultValue="255"/>`
    """
    if field.defaultValue is None:
        return
    array = (field.arrayKind.name, field.arraySize)
    kind = FieldType(field.type.name, "", field.stringBound, *array)
    try:
        write_value(field.defaultValue, kind, is_default=True)
    except ValueTextError as error:
        message = f"default {show(field.defaultValue)} of '{field.name}' {error}"
        yield Finding(field, message, "defaultValue")


@default_values.also(ros.Marker, needs=("condition", "value"))
def _markers(subject: Subject, marker: ros.Marker) -> Iterator[Finding]:
    field = marker.eContainer()
    owner = field.eContainer() if field is not None else None
    if not isinstance(field, ros.Field) or not isinstance(owner, ros.MessageType):
        return
    if not subject.is_read(field) or marker.condition is None:
        return
    try:
        condition = parse_expression(marker.condition)
    except ExpressionError as error:
        yield Finding(marker, f"condition {marker.condition!r}: {error}", "condition")
        return
    paths = {
        variable: str(field.name) if variable == VALUE else variable
        for variable in variables(condition)
    }
    faults = {variable: _number_fault(owner, path) for variable, path in paths.items()}
    for name, fault in faults.items():
        if fault:
            message = f"condition {marker.condition!r}: '{name}' {fault}"
            yield Finding(marker, message, "condition")
    if marker.value is None:
        return
    text, fault = str(marker.value), "is one of a message, which takes none"
    if isinstance(field, ros.PrimitiveField):
        fault = constant_fault(text, replace(primitive(field.type.name), is_ros=True))
    is_alone = set(paths.values()) == {str(field.name)} and not any(faults.values())
    if not fault and is_alone:
        number = {"true": 1.0, "false": 0.0}.get(text)
        numbers = dict.fromkeys(paths, float(text) if number is None else number)
        fault = "" if is_said(condition, numbers) else "does not make its condition true"
    if fault:
        yield Finding(marker, f"value {text!r} of a marker of '{field.name}' {fault}", "value")


def _number_fault(owner: ros.MessageType, path: str) -> str:
    """Says why no number that is always there stands at a path; each element of an array is one."""
    place: RosPlace | PathFault | None = RosPlace(type=owner)
    for step in path.split("."):
        place = place.step(step) if isinstance(place, RosPlace) else place
        field = place.field if isinstance(place, RosPlace) else None
        if field is not None and "[" in step and is_sequence(field):
            return "is in a sequence, which may be shorter"
    if not isinstance(place, RosPlace):
        return f"leads nowhere: {place.message}" if place is not None else ""
    return "" if place.attribute().kind in (NUMBER, NUMBERS, BOOL, OCTETS) else "is no number"


@rule("JML430", "ROS type that is too large")
def type_extents(subject: Subject) -> Iterator[Finding]:
    """A ROS type has an end: at most 64 levels, 16384 parts and 4194304 values.

    A number, a text, an array of numbers and a sequence are one part each, wherever types that it
    uses have them; arrays of types and texts count as often as they have elements. Types that use
    each other twice double with each level.

    Bad: thirty types, each with two fields of the type before it

    Good: a sequence of the type
    """
    types = subject.instances(ros.MessageType, needs=())
    for excess in excesses(types):
        message = f"'{excess.field.name}' {excess.reason}"
        yield Finding(excess.field, message, "messageType")


def _text_fault(text: str, kind: str) -> str:
    try:
        write_value(text, FieldType(kind))
    except ValueTextError as error:
        return str(error)
    return ""
