"""Attribute paths through ROS message types."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass, replace

from jausml.language.metamodel.classes import ros
from jausml.language.semantics.paths import attributes
from jausml.language.semantics.paths.markers import marks_at, marks_of, unknown
from jausml.language.semantics.subject import remembered

_COVARIANCES = {
    "geometry_msgs/PoseWithCovariance": ("m^2", "rad^2"),
    "geographic_msgs/GeoPoseWithCovariance": ("m^2", "rad^2"),
    "geometry_msgs/TwistWithCovariance": ("m^2/s^2", "rad^2/s^2"),
    "geometry_msgs/AccelWithCovariance": ("m^2/s^4", "rad^2/s^4"),
}
"""Units of the 6x6 matrix `covariance`: of x, y and z, and of the angles about them."""

_STEP = re.compile(r"(?P<name>.*?)(?P<indices>(?:\[[0-9]{1,9}\])*)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class RosPlace:
    """A place in a ROS message, from which paths go on.

    Attributes:
        type: The `ros.MessageType` of the message that stands here; None for primitive values and
            for arrays as a whole.
        may_lack: Whether a message may have no value here: a marker of a field on the way says so,
            or a sequence on it is shorter.
        says_unknown: Whether a field on the way has a marker by which it can say that.
        is_count: Whether it is the number of elements of an array.
    """

    type: ros.MessageType | None = None
    field: ros.Field | None = None
    is_array: bool = False
    is_count: bool = False
    units: str = ""
    frame: str = attributes.UNSTATED
    label: str = ""
    constants: tuple[tuple[str, str], ...] = ()
    may_lack: bool = False
    says_unknown: bool = False

    def __hash__(self) -> int:
        return hash((self.type, self.field, self.is_array, self.is_count))

    def follow(self, path: str) -> RosPlace | attributes.PathFault | None:
        """Returns the place that a path leads to; None when a part of it was not read."""
        place: RosPlace | attributes.PathFault | None = self
        for step in [] if path == "." else path.split("."):
            if not isinstance(place, RosPlace):
                return place
            place = place.step(step)
        return place

    def element(self) -> RosPlace | None:
        """Returns an element of the array at this place."""
        if self.field is None:
            return None
        inner = self.field.messageType if isinstance(self.field, ros.MessageField) else None
        marks = any(mark.is_of_elements for mark in marks_of(self.field))
        return replace(self, type=inner, is_array=False, may_lack=marks)

    def attribute(self) -> attributes.Attribute:
        """Returns the attribute of the place."""
        if self.field is None:
            return attributes.Attribute(
                "", f"a {ros_name(self.type)}" if self.type is not None else "nothing"
            )
        if self.is_count:
            return replace(attributes.count_of_elements(self.label), is_ros=True)
        value = self._array(self.field) if self.is_array else self._single(self.field)
        return replace(
            value,
            units=self.units,
            frame=self.frame,
            label=self.label,
            is_ros=True,
            field=self.field,
            may_lack=self.may_lack,
            says_unknown=self.says_unknown
            or (value.kind in attributes.EMPTY and value.count is None),
        )

    def step(self, step: str) -> RosPlace | attributes.PathFault | None:
        """Returns the place behind one name, an index included."""
        if self.is_array and self.field is not None:
            if step == attributes.COUNT:
                return replace(self, type=None, is_array=False, is_count=True)
            return _unindexed(self.field)
        if self.type is None:
            if not isinstance(self.field, ros.PrimitiveField):
                return None
            return attributes.PathFault(
                f"'{self.field.name}' is a {self.field.type.name}, it has no attributes"
            )
        fields = fields_by_name(self.type)
        name, indices = _split(step, fields)
        field = fields.get(name)
        if field is None:
            message = f"{ros_name(self.type)} has no field '{name}'"
            return attributes.PathFault(message, attributes.nearest_name(name, self.type.fields))
        fault = _index_fault(field, indices)
        if fault is not None:
            return fault
        place = self._inside(field, is_element=bool(indices))
        place = replace(place, constants=named_constants(self.type))
        if indices and field.name == "covariance" and not field.units:
            return replace(place, units=_covariance_units(self.type, indices[0]))
        return place

    def _inside(self, field: ros.Field, *, is_element: bool) -> RosPlace:
        is_array = field.arrayKind.name != "single" and not is_element
        inner = field.messageType if isinstance(field, ros.MessageField) else None
        frame = field.frame.name
        is_shorter = is_element and is_sequence(field)
        return RosPlace(
            type=inner if not is_array else None,
            field=field,
            is_array=is_array,
            units=field.units or self.units,
            frame=frame if frame != attributes.UNSTATED else self.frame,
            label=field.name,
            may_lack=self.may_lack or is_shorter or bool(marks_at(field, is_element=not is_array)),
            says_unknown=self.says_unknown or unknown(field) is not None,
        )

    def _array(self, field: ros.Field) -> attributes.Attribute:
        element = self._single(field)
        kind = field.arrayKind.name
        count = field.arraySize if kind == "fixedArray" else None
        name = f"an array of {element.name.removeprefix('a ')}"
        if isinstance(field, ros.PrimitiveField):
            if field.type.name == "uint8" and kind == "unboundedSequence":
                return attributes.Attribute(attributes.OCTETS, "a sequence of uint8")
            if element.kind == attributes.NUMBER:
                return replace(element, kind=attributes.NUMBERS, name=name, count=count)
        return attributes.Attribute(attributes.LIST, name, count=count)

    def _single(self, field: ros.Field) -> attributes.Attribute:
        if not isinstance(field, ros.PrimitiveField):
            target = field.messageType if isinstance(field, ros.MessageField) else None
            name = ros_name(target) if target is not None else "a message"
            return attributes.Attribute(name, f"a {name}")
        if field.type.name in ("string", "wstring"):
            return attributes.Attribute(attributes.TEXT, "text", length=field.stringBound or None)
        value = replace(attributes.primitive(field.type.name), constants=self.constants)
        if value.kind == attributes.NUMBER and field.minimum < field.maximum:
            return replace(value, lower=field.minimum, upper=field.maximum)
        return value


def ros_name(message_type: ros.MessageType | ros.ServiceType | ros.ActionType) -> str:
    """Returns the full name of a ROS type: `geometry_msgs/Pose`, `std_srvs/SetBool.request`."""
    owner = message_type.eContainer()
    if isinstance(owner, ros.ServiceType | ros.ActionType):
        return f"{ros_name(owner)}.{message_type.eContainmentFeature().name}"
    prefix = f"{owner.name}/" if owner is not None and owner.name else ""
    return f"{prefix}{message_type.name}"


@remembered
def fields_by_name(message_type: ros.MessageType) -> dict[str, ros.Field]:
    """Returns the fields of a type, of several with one name the first."""
    return {str(field.name): field for field in reversed(message_type.fields)}


@remembered
def named_constants(message_type: ros.MessageType) -> tuple[tuple[str, str], ...]:
    """Returns the names of the constants of a type, with their values as text."""
    return tuple((str(constant.name), str(constant.value)) for constant in message_type.constants)


def _covariance_units(owner: ros.MessageType, index: int) -> str:
    """Returns the unit of an element of a 6x6 covariance matrix; empty where it is of two kinds."""
    units = _COVARIANCES.get(ros_name(owner))
    row, column = divmod(index, 6)
    if units is None or (row < 3) is not (column < 3):
        return ""
    return units[0] if row < 3 else units[1]


def _split(step: str, known: Container[str]) -> tuple[str, list[int]]:
    """Splits `name[3]`; a name that holds brackets itself wins."""
    match = _STEP.fullmatch(step)
    if step in known or match is None:
        return step, []
    return match["name"], [int(occurrence) for occurrence in re.findall("[0-9]+", match["indices"])]


def is_sequence(field: ros.Field) -> bool:
    """Tells whether a field is an array with a number of elements by message."""
    return field.arrayKind.name not in ("single", "fixedArray")


def is_bounded(field: ros.Field) -> bool:
    """Tells whether a field is an array with a largest number of elements."""
    return field.arrayKind.name in ("fixedArray", "boundedSequence")


def _index_fault(field: ros.Field, indices: list[int]) -> attributes.PathFault | None:
    if not indices:
        return None
    if field.arrayKind.name == "single":
        return attributes.PathFault(f"'{field.name}' is not an array, it has no [{indices[0]}]")
    if len(indices) > 1:
        return attributes.PathFault(f"'{field.name}' has one dimension")
    if is_bounded(field) and indices[0] >= field.arraySize:
        size = f"{'at most ' if is_sequence(field) else ''}{field.arraySize}"
        return attributes.PathFault(
            f"'{field.name}' has {size} elements, counted from 0: no [{indices[0]}]"
        )
    return None


def _unindexed(field: ros.Field) -> attributes.PathFault:
    if field.arrayKind.name == "fixedArray":
        return attributes.PathFault(
            f"'{field.name}' is an array", f"name one element: {field.name}[0]"
        )
    hint = "translate its elements by a ListAssignment"
    return attributes.PathFault(f"'{field.name}' is an array", hint)
