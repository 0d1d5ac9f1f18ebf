"""Rules about attribute maps: paths, types, constants, conversions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.model.diagnostics import Severity
from jausml.validation.facts.attributes import (
    BOOL,
    NUMBER,
    TIME,
    TIME_STAMP,
    Attribute,
    Found,
    PathFault,
)
from jausml.validation.facts.conversions import conversion_signature, conversions_between
from jausml.validation.facts.layouts import attributes, class_name
from jausml.validation.facts.paths import jaus_attribute, parse_path, ros_attribute
from jausml.validation.facts.values import constant_fault
from jausml.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.validation.subject import Subject


@dataclass(frozen=True, slots=True)
class _Side:
    """One direction of a map, or the safe value of a connection: what is filled from what.

    Attributes:
        assignments: The assignments, without those that were not read well.
        to_ros: Whether they fill the ROS type.
        map: The map.
    """

    assignments: tuple[Any, ...]
    to_ros: bool
    map: Any

    def target(self, assignment: Any) -> Found:
        return self._follow(assignment.target, ros=self.to_ros)

    def sources(self, assignment: Any) -> list[tuple[str, Found]]:
        paths = [path.strip() for path in assignment.source.split(",")]
        return [(path, self._follow(path, ros=not self.to_ros)) for path in paths]

    def _follow(self, path: str, *, ros: bool) -> Found:
        if ros:
            return ros_attribute(self.map.type, path)
        return jaus_attribute(self.map.message, path)


@rule("JML411", Severity.ERROR, "no such attribute")
def paths(subject: Subject) -> Iterator[Finding]:
    """The paths of an assignment lead to attributes of the JAUS message and of the ROS type.

    JAUS paths start at the members of the top record or sequence of the message; ROS paths at
    the fields of the type. Elements of fixed arrays are named by index: `covariance[7]`.

    Bad: `target="twist.lin.x"`

    Good: `target="twist.linear.x"`
    """
    for side in _sides(subject):
        for assignment in side.assignments:
            found = side.target(assignment)
            if isinstance(found, PathFault):
                message = f"target '{assignment.target}': {found.message}"
                yield Finding(assignment, message, "target", found.hint)
            if class_name(assignment) != "FieldAssignment":
                continue
            for path, source in side.sources(assignment):
                if isinstance(source, PathFault):
                    message = f"source '{path}': {source.message}"
                    yield Finding(assignment, message, "source", source.hint)


@rule("JML412", Severity.ERROR, "value does not fit the target")
def types(subject: Subject) -> Iterator[Finding]:
    """What an assignment yields is of the kind that its target takes.

    Numbers go to numbers, text to text, bool to bool or to an unscaled integer and back, octets of
    a variable-length field to a sequence of uint8 and back. A JAUS TimeStamp becomes a
    builtin_interfaces/Time, and angles become a quaternion, by a conversion. Whole records, lists
    and arrays are translated in the skeleton of the bridge.

    Bad: `target="header.stamp" source="TimeStamp"` without a conversion

    Good: the same with `<conversions kind="timestamp_to_time"/>`
    """
    for side in _sides(subject):
        for assignment in side.assignments:
            target = side.target(assignment)
            if not isinstance(target, Attribute):
                continue
            if class_name(assignment) == "ClockAssignment":
                if target.kind not in (TIME, TIME_STAMP):
                    message = f"'{assignment.target}' is {target.name}, it takes no time"
                    yield Finding(assignment, message, "target")
            elif class_name(assignment) == "FieldAssignment":
                yield from _type_findings(subject, side, assignment, target)


@rule("JML413", Severity.ERROR, "constant does not fit the target")
def constants(subject: Subject) -> Iterator[Finding]:
    """A constant is a value of its target: a number in its range, true or false, or text.

    Bad: `target="PropulsiveLinearEffortX" value="101"`, where the field ends at 100

    Good: `value="100"`
    """
    for side in _sides(subject):
        for assignment in side.assignments:
            if class_name(assignment) != "ConstantAssignment" or assignment.value is None:
                continue
            target = side.target(assignment)
            if isinstance(target, Attribute):
                fault = constant_fault(assignment.value, target)
                if fault:
                    message = f"constant {assignment.value!a} of '{assignment.target}' {fault}"
                    yield Finding(assignment, message, "value")


@rule("JML414", Severity.ERROR, "conversion used wrongly")
def conversions(subject: Subject) -> Iterator[Finding]:
    """A conversion has the arguments and the inputs that it takes.

    The first one takes the sources, each further one the result of the one before.

    Bad: `<conversions kind="scale"/>`, which takes a factor

    Good: `<conversions kind="scale"><arguments>0.1</arguments></conversions>`
    """
    for conversion in subject.instances("bridge.Conversion"):
        yield from _argument_findings(conversion)
    for side in _sides(subject):
        for assignment in side.assignments:
            if class_name(assignment) == "FieldAssignment":
                yield from _chain_findings(side, assignment)


@rule("JML415", Severity.ERROR, "target assigned twice")
def targets_unique(subject: Subject) -> Iterator[Finding]:
    """An attribute is the target of one assignment of a direction.

    An assignment of a whole, such as `pose.orientation`, and one of a part of it, such as
    `pose.orientation.w`, exclude each other; so do an assignment and an Ignore.

    Bad: two assignments with `target="twist.linear.x"`

    Good: one
    """
    for side in _sides(subject):
        seen: dict[tuple[str, ...], Any] = {}
        for assignment in side.assignments:
            path = parse_path(assignment.target)
            first = next((a for other, a in seen.items() if _overlaps(path, other)), None)
            if first is not None:
                message = f"'{assignment.target}' is assigned already"
                note = Note(first, f"'{first.target}'", "target")
                yield Finding(assignment, message, "target", related=(note,))
            seen.setdefault(path, assignment)


@rule("JML416", Severity.WARNING, "required JAUS field not assigned")
def required_fields(subject: Subject) -> Iterator[Finding]:
    """Each member of a JAUS message that is not optional is assigned, or ignored on purpose.

    It is on the wire in any case, with the smallest legal value when nothing is assigned.

    Bad: a map to SetTravelSpeed without an assignment to Speed

    Good: `<toJaus xsi:type="bridge:Ignore" target="Speed" documentation="..."/>`
    """
    for each in subject.instances("bridge.AttributeMap"):
        if not each.toJaus or not subject.is_intact(each, each.message):
            continue
        assigned = {parse_path(a.target)[0] for a in each.toJaus if a.target}
        for field in attributes(each.message):
            if not field.optional and field.name and parse_path(field.name)[0] not in assigned:
                message = f"'{field.name}' of {each.message.name} is required, but not assigned"
                yield Finding(each, message, "toJaus", "assign it, or add an Ignore")


def _sides(subject: Subject) -> Iterator[_Side]:
    """Yields all directions of all maps, and safe values, as far as both ends were read."""
    for each in subject.instances("bridge.AttributeMap"):
        if subject.is_intact(each.message, each.type):
            yield _Side(_sound(subject, each.toRos), to_ros=True, map=each)
            yield _Side(_sound(subject, each.toJaus), to_ros=False, map=each)
    for connection in subject.instances("bridge.Connection"):
        used = connection.map
        if used is not None and subject.is_intact(used.message, used.type):
            to_ros = connection.direction.name == "jausToRos"
            yield _Side(_sound(subject, connection.safeValue), to_ros=to_ros, map=used)


def _sound(subject: Subject, assignments: Any) -> tuple[Any, ...]:
    return tuple(
        each
        for each in assignments
        if subject.is_intact(each)
        and each.target is not None
        and (class_name(each) != "FieldAssignment" or each.source is not None)
    )


def _type_findings(
    subject: Subject, side: _Side, assignment: Any, target: Attribute
) -> Iterator[Finding]:
    values: list[Attribute] = []
    for path, found in side.sources(assignment):
        if not isinstance(found, Attribute):
            return
        if not found.kind:
            hint = "translate it in the skeleton of the bridge"
            yield Finding(assignment, f"'{path}' is {found.name}", "source", hint)
            return
        values.append(found)
    if not target.kind:
        hint = "fill it in the skeleton of the bridge"
        yield Finding(assignment, f"'{assignment.target}' is {target.name}", "target", hint)
        return
    if assignment.conversions:
        output = conversion_signature(assignment.conversions[-1].kind).output
        if output != target.kind:
            message = f"{assignment.conversions[-1].kind.name} yields {output}"
            message += f", but '{assignment.target}' is {target.name}"
            yield Finding(assignment, message, "target")
    elif len(values) == 1 and not _fits(values[0], target):
        kinds = [value.kind for value in values]
        known = conversions_between(subject.model.metamodels, kinds, target.kind)
        hint = f"convert it by {' or '.join(known)}" if known else ""
        message = f"'{assignment.source}' is {values[0].name}"
        message += f", but '{assignment.target}' is {target.name}"
        yield Finding(assignment, message, "target", hint)


def _fits(value: Attribute, target: Attribute) -> bool:
    if value.kind == target.kind:
        return True
    kinds = {value.kind, target.kind}
    number = value if value.kind == NUMBER else target
    return kinds == {BOOL, NUMBER} and number.integral


def _argument_findings(conversion: Any) -> Iterator[Finding]:
    name = conversion.kind.name
    wanted = conversion_signature(conversion.kind).arguments
    values = list(conversion.arguments)
    if len(values) != len(wanted):
        takes = f"takes {' and '.join(wanted)}" if wanted else "takes no arguments"
        message = f"{name} {takes}, {len(values)} given"
        yield Finding(conversion, message, "arguments" if values else None)
    elif not all(math.isfinite(value) for value in values):
        yield Finding(conversion, f"{name} has an argument that is not finite", "arguments")
    elif name == "clamp" and values[0] > values[1]:
        message = f"clamp has minimum {values[0]:g} above maximum {values[1]:g}"
        yield Finding(conversion, message, "arguments")
    elif name == "deadband" and values[0] < 0:
        yield Finding(conversion, f"deadband has the negative width {values[0]:g}", "arguments")


def _chain_findings(side: _Side, assignment: Any) -> Iterator[Finding]:
    sources = side.sources(assignment)
    found = [each for _, each in sources if isinstance(each, Attribute) and each.kind]
    if len(found) < len(sources):
        return
    kinds = [each.kind for each in found]
    if not assignment.conversions:
        if len(kinds) > 1:
            message = f"{len(kinds)} sources without a conversion that takes them"
            yield Finding(assignment, message, "source")
        return
    for conversion in assignment.conversions:
        signature = conversion_signature(conversion.kind)
        if tuple(kinds) != signature.inputs:
            message = f"{conversion.kind.name} takes {', '.join(signature.inputs)}"
            yield Finding(conversion, f"{message}, but gets {', '.join(kinds)}", "kind")
            return
        kinds = [signature.output]


def _overlaps(first: tuple[str, ...], second: tuple[str, ...]) -> bool:
    common = min(len(first), len(second))
    return first[:common] == second[:common]


RULES = (paths, types, constants, conversions, targets_unique, required_fields)
