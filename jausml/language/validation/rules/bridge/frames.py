"""Rules about axes and coordinates: what points where in ROS and in JAUS, and ROS headers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments import frames
from jausml.language.semantics.assignments.frames import (
    BODY,
    EARTH,
    FAMILIES,
    IS_DOWN,
    LOCAL,
    Axis,
    Passage,
)
from jausml.language.semantics.assignments.steps import steps_of
from jausml.language.semantics.assignments.units import attribute_measure, units_clash
from jausml.language.semantics.conversions import Conversion
from jausml.language.semantics.conversions.conversion import DOWN, ENU, NED, UP
from jausml.language.semantics.conversions.numbers import Negate
from jausml.language.semantics.paths.attributes import Attribute, Found
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import Direction, Placed, parse_path, target_paths
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_OPPOSITE = "have opposite signs"


@rule("JML433", "axes do not match", kinds=Direction)
def frame_mismatch(_: Subject, direction: Direction) -> Iterator[Finding]:
    """A number goes from axis to axis with the sign that the frames of both ends require.

    ROS bodies are forward-left-up, JAUS bodies forward-right-down: x stays, y and z change their
    sign, and so do pitch, yaw and their rates. On the earth ROS has east-north-up and JAUS north-
    east-down: x and y change places, z changes its sign, and a heading has another zero. Local
    frames differ in either way, but in one direction of a map in the same way. A body vector does
    not go to axes of the earth without the attitude of the body. The frame is that of the field, or
    of the field around it; where one end states none, nothing is reported. Expressions, tables and
    methods of the skeleton are the author's responsibility.

    Bad: `target="twist.linear.y" source="Velocity_Y"`

    Good: the same with `<conversions kind="negate"/>`
    """
    turning: dict[bool, Placed[bridge.FieldAssignment]] = {}
    for placed in direction.of_kind(bridge.FieldAssignment):
        finding = _finding(placed)
        if finding is not None:
            yield finding
            continue
        is_turned = _turns_local_axes(placed)
        if is_turned is None:
            continue
        turning.setdefault(is_turned, placed)
        other = turning.get(not is_turned)
        if other is not None:
            yield _inconsistent(placed, other, "exchanges" if is_turned else "keeps")


def _inconsistent(
    placed: Placed[bridge.FieldAssignment], other: Placed[bridge.FieldAssignment], verb: str
) -> Finding:
    opposite = "keeps" if verb == "exchanges" else "exchanges"
    target, first = placed.assignment.target, other.assignment.target
    message = f"'{target}' {verb} the horizontal axes of the local frame, but '{first}'"
    note = Note(other.assignment, f"'{first}'", "target")
    return Finding(placed.assignment, f"{message} {opposite} them", "target", related=(note,))


def _turns_local_axes(placed: Placed[bridge.FieldAssignment]) -> bool | None:
    """Whether x and y of two local frames change places; None where nothing tells."""
    passage = frames.passage(steps_of(placed), placed.source_attributes)
    targets = [frames.axis_of(target_attribute) for target_attribute in placed.target_attributes]
    if passage is None or not targets or not passage.sources:
        return None
    source, target = passage.sources[0], targets[0]
    if source is None or target is None or {source.frame, target.frame} != {UP, DOWN}:
        return None
    if passage.conversion is not None:
        return EARTH in {FAMILIES[frame] for frame in passage.conversion.frames}
    if source.is_angle or "z" in (source.name, target.name):
        return None
    return source.name != target.name


def _finding(placed: Placed[bridge.FieldAssignment]) -> Finding | None:
    if not placed.source_attributes or not placed.target_attributes or units_clash(placed):
        return None
    passage = frames.passage(steps_of(placed), placed.source_attributes)
    if passage is None:
        return None
    targets = [frames.axis_of(target_attribute) for target_attribute in placed.target_attributes]
    if passage.conversion is not None:
        return _converted(placed, passage, passage.conversion, targets)
    source, target = passage.sources[0], targets[0]
    if len(passage.sources) > 1 or len(targets) > 1 or source is None or target is None:
        return None
    if not (source.name and target.name) or _makes_another_quantity(placed):
        return None
    return _direct(placed, frames.with_sign(source, passage.sign), target)


def _makes_another_quantity(placed: Placed[bridge.FieldAssignment]) -> bool:
    """Whether a factor makes one kind of quantity of another, such as speed of a turning rate."""
    ends = placed.source_attributes[0], placed.target_attributes[0]
    dimensions = {
        measure.unit.dimension for measure in map(attribute_measure, ends) if measure is not None
    }
    return len(dimensions - {()}) > 1


def _direct(placed: Placed[bridge.FieldAssignment], source: Axis, target: Axis) -> Finding | None:
    """Compares the axes of a number that no conversion moved between frames."""
    families = FAMILIES[source.frame], FAMILIES[target.frame]
    if source.frame != target.frame and BODY in families and set(families) != {BODY}:
        hint = "turn it by the attitude of the body, in an expression or in the skeleton"
        return _mismatch(placed, source, target, "are not comparable", hint)
    if set(families) == {LOCAL, EARTH}:
        is_turned = IS_DOWN[source.frame] != IS_DOWN[target.frame]
        is_vertical = source.name == target.name == "z"
        if is_vertical and (source.sign < 0) != is_turned:
            return _mismatch(placed, source, target, _OPPOSITE, _negation(placed))
        return None
    if _is_heading(source, target):
        other = frames.angle_conversion(source.frame, target.frame)
        hint = f"convert it by {other.name}" if other is not None else ""
        return _mismatch(placed, source, target, "have different zeros", hint)
    from_, to = frames.direction(source), frames.direction(target)
    # Whether all of a map exchanges x and y is told for the direction as a whole.
    if families == (LOCAL, LOCAL) and _is_exchange(source, target):
        return None
    if from_[0] != to[0]:
        return _mismatch(placed, source, target, "are different directions", _exchange(source))
    if from_[1] != to[1]:
        return _mismatch(placed, source, target, _OPPOSITE, _negation(placed))
    return None


def _is_exchange(source: Axis, target: Axis) -> bool:
    """Whether x goes to y or y to x, as from north-east-down to east-north-up."""
    are_lengths = not source.is_angle and not target.is_angle
    are_horizontal = {source.name, target.name} == {"x", "y"} and source.sign > 0
    return source.frame != target.frame and are_lengths and are_horizontal


def _is_heading(source: Axis, target: Axis) -> bool:
    are_angles = source.is_angle and target.is_angle and source.name == target.name == "z"
    return are_angles and {source.frame, target.frame} == {ENU, NED}


def _converted(
    placed: Placed[bridge.FieldAssignment],
    passage: Passage,
    conversion: Conversion,
    targets: list[Axis | None],
) -> Finding | None:
    """Checks a conversion between frames against the frames of both ends."""
    taken, target_frame = conversion.frames
    name = conversion.name
    wrong = _order(name, passage.sources, conversion.takes_axes, placed.sources)
    wrong = wrong or _order(name, targets, conversion.gives_axes, placed.targets)
    if wrong:
        return Finding(placed.assignment, wrong, "conversions")
    if passage.sign == -1:
        message = f"{name} has the signs of both frames already"
        return Finding(placed.assignment, message, "conversions", "leave out the further sign")
    for source in passage.sources:
        for target in targets:
            problem = _ends_problem(source, target, taken, target_frame)
            if problem:
                message = f"{name} is for {taken} and {target_frame}, but {problem}"
                element = next(
                    candidate
                    for candidate in placed.assignment.conversions
                    if candidate.kind.name == name
                )
                return Finding(element, message, "kind", _other(conversion, source, target))
    return None


def _order(
    name: str,
    axes: Sequence[Axis | None],
    wanted: tuple[str, ...],
    paths: Sequence[tuple[str, Found]],
) -> str:
    for axis, expected, (path, _) in zip(axes, wanted, paths, strict=False):
        if axis is not None and axis.name and expected and axis.name != expected:
            turned = {"x": "roll", "y": "pitch", "z": "yaw"}
            return f"{name} has {turned[expected]} in the place of '{path}'"
    return ""


def _ends_problem(source: Axis | None, target: Axis | None, taken: str, target_frame: str) -> str:
    """Says which end is in a frame that a conversion is not for."""
    for axis, wanted in ((source, taken), (target, target_frame)):
        if axis is None:
            continue
        verb = "the source is" if axis is source else "the target is"
        is_of_body = FAMILIES[axis.frame] == BODY and FAMILIES[wanted] == EARTH
        if is_of_body or IS_DOWN[axis.frame] != IS_DOWN[wanted]:
            return f"{verb} {axis.frame}"
    if source is None or target is None:
        return ""
    ends = {FAMILIES[source.frame], FAMILIES[target.frame]}
    if ends == {EARTH} and taken not in (ENU, NED):
        return f"it goes from {source.frame} to {target.frame}"
    return ""


def _other(conversion: Conversion, source: Axis | None, target: Axis | None) -> str:
    is_of_earth = EARTH in {FAMILIES[axis.frame] for axis in (source, target) if axis is not None}
    other = frames.counterpart(conversion)
    if other is None or is_of_earth != (FAMILIES[other.frames[0]] == EARTH):
        return ""
    return f"use {other.name}"


def _mismatch(
    placed: Placed[bridge.FieldAssignment], source: Axis, target: Axis, problem: str, hint: str
) -> Finding:
    left, right = (_described(axis) for axis in (source, target))
    message = f"'{placed.sources[0][0]}' ({left}) and '{placed.targets[0][0]}' ({right}) {problem}"
    return Finding(placed.assignment, message, "target", hint)


def _described(axis: Axis) -> str:
    sign = "-" if axis.sign < 0 else ""
    return f"{sign}{axis.name} of {axis.frame}"


def _negation(placed: Placed[bridge.FieldAssignment]) -> str:
    names = [conversion.kind.name for conversion in placed.assignment.conversions]
    return (
        f"leave out {Negate.name}" if Negate.name in names else f"add the conversion {Negate.name}"
    )


def _exchange(source: Axis) -> str:
    names = {"x": "y", "y": "x"}
    if FAMILIES[source.frame] == EARTH and not source.is_angle and source.name in names:
        return f"east is x of {ENU} and y of {NED}, north is y of {ENU} and x of {NED}"
    return ""


@rule("JML458", "coordinates exchanged", kinds=Direction)
def geodetic_coordinates(_: Subject, direction: Direction) -> Iterator[Finding]:
    """A latitude stays a latitude, a longitude a longitude, and an altitude points up.

    Both ends say which of them they are. The z axis of a local frame of JAUS points down: an
    altitude that goes there, or comes from there, changes its sign.

    Bad: `target="longitude" source="Latitude"`

    Good: `target="latitude" source="Latitude"`
    """
    for placed in direction.of_kind(bridge.FieldAssignment):
        sources, targets = placed.source_attributes, placed.target_attributes
        if len(sources) == len(targets) == 1:
            yield from _exchanged(placed, sources[0], targets[0])


def _exchanged(
    placed: Placed[bridge.FieldAssignment], source: Attribute, target: Attribute
) -> Iterator[Finding]:
    coordinate, wanted = frames.geodetic(source), frames.geodetic(target)
    from_, to = placed.sources[0][0], placed.targets[0][0]
    if coordinate and wanted:
        if coordinate != wanted:
            message = f"'{from_}' is a {coordinate}, but '{to}' a {wanted}"
            yield Finding(placed.assignment, message, "source")
    elif frames.ALTITUDE in (coordinate, wanted):
        passage = frames.passage(steps_of(placed), placed.source_attributes)
        axis = frames.axis_of(target if coordinate else source)
        if passage is None or axis is None or axis.name != "z":
            return
        if (passage.sign < 0) != IS_DOWN[axis.frame]:
            down = "down" if IS_DOWN[axis.frame] else "up"
            names = f"'{from_ if coordinate else to}'", f"'{to if coordinate else from_}'"
            message = f"{names[0]} points up, and {names[1]} points {down}"
            done = any(
                conversion.kind.name == Negate.name for conversion in placed.assignment.conversions
            )
            hint = f"leave out {Negate.name}" if done else f"add the conversion {Negate.name}"
            yield Finding(placed.assignment, message, "target", hint)


_HEADER = "std_msgs/Header"
_PARTS = ("stamp", "frame_id")


@rule("JML460", "header without time or frame", severity=Severity.WARNING, kinds=Direction)
def headers_filled(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """A ROS message with a header gets its stamp and its frame_id, or leaves them out on purpose.

    A stamp of 0 lies in 1970, and tf2 transforms nothing that has no frame: subscribers drop such a
    message or, even worse, use it.

    Bad: a map to nav_msgs/Odometry whose assignments do not name header

    Good: `header.stamp` by the clock or from the TimeStamp, and a constant for `header.frame_id`
    """
    owner = direction.owner
    if not direction.to_ros or not isinstance(owner, bridge.AttributeMap):
        return
    if not owner.toRos or not subject.is_intact(owner, *owner.toRos):
        return
    header = next((field for field in direction.map.type.fields if _is_header(field)), None)
    if header is None:
        return
    assigned = {parse_path(path) for assignment in owner.toRos for path in target_paths(assignment)}
    names = [
        f"{header.name}.{part}"
        for part in _PARTS
        if not assigned & {(header.name,), (header.name, part)}
        and not any(path[:2] == (header.name, part) for path in assigned)
    ]
    if names:
        message = f"map '{owner.name}' gives {' and '.join(names)} no value"
        yield Finding(owner, message, "toRos", "assign it, or add an Ignore")


@rule("JML461", "frame id with a slash in front", kinds=Direction)
def frame_ids(_: Subject, direction: Direction) -> Iterator[Finding]:
    """The id of a frame does not begin with a slash, because tf2 refuses such ids.

    Bad: `target="header.frame_id" value="/odom"`

    Good: `target="header.frame_id" value="odom"`
    """
    if not direction.to_ros:
        return
    for placed in direction.of_kind(bridge.ConstantAssignment):
        constant = placed.assignment
        last = (constant.target or "").strip().rpartition(".")[2]
        if last.endswith("frame_id") and (constant.value or "").startswith("/"):
            message = f"frame id '{constant.value}' begins with a slash"
            yield Finding(constant, message, "value", f"write {constant.value.lstrip('/')}")


def _is_header(field: ros.Field) -> bool:
    kind = field.messageType if isinstance(field, ros.MessageField) else None
    return kind is not None and field.arrayKind.name == "single" and ros_name(kind) == _HEADER
