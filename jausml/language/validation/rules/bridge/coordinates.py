"""Rules about coordinates and the headers of ROS messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments import frames
from jausml.language.semantics.assignments.frames import IS_DOWN
from jausml.language.semantics.assignments.steps import steps_of
from jausml.language.semantics.conversions.numbers import Negate
from jausml.language.semantics.paths.attributes import Attribute
from jausml.language.semantics.paths.directions import directions
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import parse_path, target_paths
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.paths.scopes import Placed
    from jausml.language.semantics.subject import Subject


_GEODETIC = "geodetic"
_ALTITUDE = "altitude"
_COORDINATES = frozenset({"latitude", "longitude", _ALTITUDE})
_POINTS = frozenset({"Point", "Point32"})


@rule("JML458", Severity.ERROR, "coordinates exchanged")
def geodetic_coordinates(subject: Subject) -> Iterator[Finding]:
    """A latitude stays a latitude, a longitude a longitude, and an altitude points up.

    Both ends say which of them they are. The z axis of a local frame of JAUS points down: an
    altitude that goes there, or comes from there, changes its sign.

    Bad: `target="longitude" source="Latitude"`

    Good: `target="latitude" source="Latitude"`
    """
    for direction in directions(subject):
        for placed in direction.of_kind(bridge.FieldAssignment):
            sources, targets = placed.source_attributes, placed.target_attributes
            if len(sources) == len(targets) == 1:
                yield from _exchanged(placed, sources[0], targets[0])


def _exchanged(
    placed: Placed[bridge.FieldAssignment], source: Attribute, target: Attribute
) -> Iterator[Finding]:
    given, wanted = _coordinate(source), _coordinate(target)
    from_, to = placed.sources[0][0], placed.targets[0][0]
    if given and wanted:
        if given != wanted:
            message = f"'{from_}' is a {given}, but '{to}' a {wanted}"
            yield Finding(placed.assignment, message, "source")
    elif _ALTITUDE in (given, wanted):
        passage = frames.passage(steps_of(placed), placed.source_attributes)
        axis = frames.axis_of(target if given else source)
        if passage is None or passage.sign is None or axis is None or axis.name != "z":
            return
        if (passage.sign < 0) != IS_DOWN[axis.frame]:
            down = "down" if IS_DOWN[axis.frame] else "up"
            names = f"'{from_ if given else to}'", f"'{to if given else from_}'"
            message = f"{names[0]} points up, and {names[1]} points {down}"
            done = any(each.kind.name == Negate.name for each in placed.assignment.conversions)
            hint = f"leave out {Negate.name}" if done else f"add the conversion {Negate.name}"
            yield Finding(placed.assignment, message, "target", hint)


@rule("JML459", Severity.WARNING, "absent coordinate published as the origin")
def absent_coordinates(subject: Subject) -> Iterator[Finding]:
    """The assignment of a coordinate that a JAUS report may leave out says what ROS gets then.

    With `whenAbsent="leave"`, which is the default, it stays 0 as ROS makes it: a report without a
    position puts the vehicle on the origin. The height in a local frame may be left out: a vehicle
    on the ground stands at 0.

    Bad: `target="pose.position.x" source="X"` where X is optional

    Good: the same with `whenAbsent="dropMessage"`, or with `useDefault` and a `defaultValue`
    """
    for direction in directions(subject):
        if not direction.to_ros:
            continue
        for placed in direction.of_kind(bridge.FieldAssignment):
            if placed.assignment.whenAbsent.name != "leave":
                continue
            absent = next((path for path, found in placed.sources if _is_optional(found)), None)
            origin = next((path for path, found in placed.targets if _is_coordinate(found)), None)
            if absent is not None and origin is not None:
                message = f"without '{absent}' '{origin}' is 0, where nobody is"
                hint = "whenAbsent dropMessage, or useDefault with a defaultValue"
                yield Finding(placed.assignment, message, "whenAbsent", hint)


def _coordinate(attribute: Attribute) -> str:
    name = attribute.label.lower()
    return name if attribute.frame == _GEODETIC and name in _COORDINATES else ""


def _is_optional(found: object) -> bool:
    return isinstance(found, Attribute) and found.optional


def _is_coordinate(found: object) -> bool:
    if not isinstance(found, Attribute) or found.field is None:
        return False
    owner = found.field.eContainer()
    is_horizontal = getattr(owner, "name", None) in _POINTS and found.label in ("x", "y")
    return is_horizontal or bool(_coordinate(found))


_HEADER = "std_msgs/Header"
_PARTS = ("stamp", "frame_id")


@rule("JML460", Severity.WARNING, "header without time or frame")
def headers_filled(subject: Subject) -> Iterator[Finding]:
    """A ROS message with a header gets its stamp and its frame_id, or leaves them out on purpose.

    A stamp of 0 lies in 1970, and tf2 transforms nothing that has no frame: subscribers drop such a
    message or, even worse, use it.

    Bad: a map to nav_msgs/Odometry whose assignments do not name header

    Good: `header.stamp` by the clock or from the TimeStamp, and a constant for `header.frame_id`
    """
    for direction in directions(subject):
        owner = direction.owner
        if not direction.to_ros or not isinstance(owner, bridge.AttributeMap):
            continue
        if not owner.toRos or not subject.is_intact(owner, *owner.toRos):
            continue
        header = next((each for each in direction.map.type.fields if _is_header(each)), None)
        if header is None:
            continue
        assigned = {parse_path(path) for each in owner.toRos for path in target_paths(each)}
        names = [
            f"{header.name}.{part}"
            for part in _PARTS
            if not assigned & {(header.name,), (header.name, part)}
            and not any(path[:2] == (header.name, part) for path in assigned)
        ]
        if names:
            message = f"map '{owner.name}' gives {' and '.join(names)} no value"
            yield Finding(owner, message, "toRos", "assign it, or add an Ignore")


@rule("JML461", Severity.ERROR, "frame id with a slash in front")
def frame_ids(subject: Subject) -> Iterator[Finding]:
    """The id of a frame does not begin with a slash, because tf2 refuses such ids.

    Bad: `target="header.frame_id" value="/odom"`

    Good: `target="header.frame_id" value="odom"`
    """
    for direction in directions(subject):
        if not direction.to_ros:
            continue
        for placed in direction.of_kind(bridge.ConstantAssignment):
            constant = placed.assignment
            last = (constant.target or "").strip().rpartition(".")[2]
            if last.endswith("frame_id") and (constant.value or "").startswith("/"):
                message = f"frame id '{constant.value}' begins with a slash"
                yield Finding(constant, message, "value", f"write {constant.value.lstrip('/')}")


def _is_header(field: ros.Field) -> bool:
    kind = field.messageType if isinstance(field, ros.MessageField) else None
    return kind is not None and field.arrayKind.name == "single" and ros_name(kind) == _HEADER
