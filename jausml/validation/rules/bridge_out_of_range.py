"""Rules about what happens to values that the target of an assignment cannot carry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.model.diagnostics import Severity
from jausml.validation.facts.attributes import NUMBER, OCTETS, TEXT, Attribute
from jausml.validation.facts.layouts import class_name
from jausml.validation.facts.paths import jaus_attribute
from jausml.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.validation.subject import Subject

_DROP_FIELD = "dropField"
_HINT = "clamp, dropMessage or error"
_LIMITED = (NUMBER, TEXT, OCTETS)
_MOST_NOTES = 3


@rule("JML417", Severity.ERROR, "field that cannot be left out")
def left_out_fields(subject: Subject) -> Iterator[Finding]:
    """The policy dropField is for optional fields of JAUS messages.

    A JAUS message has its other fields in any case, and so has a ROS message all of its fields:
    left out, they would carry a number that nobody measured. The policy of a connection counts for
    the assignments of its direction that have none of their own.

    Bad: `outOfRange="dropField"` with `target="Speed"` of SetTravelSpeed, which has no optional
    field

    Good: the same with `outOfRange="dropMessage"`
    """
    for each in subject.instances("bridge.AttributeMap"):
        for to_ros in (True, False):
            for assignment in _assignments(subject, each, to_ros=to_ros):
                policy = assignment.outOfRange.name
                if policy == _DROP_FIELD and _must_be_there(each, assignment, to_ros=to_ros):
                    message = f"'{assignment.target}' is no optional JAUS field, it is never"
                    yield Finding(assignment, f"{message} left out", "outOfRange", _HINT)
    for connection in subject.instances("bridge.Connection"):
        if connection.outOfRange.name == _DROP_FIELD and connection.map is not None:
            yield from _connection_findings(subject, connection)


@rule("JML418", Severity.WARNING, "values that cannot be clamped")
def clamped_values(subject: Subject) -> Iterator[Finding]:
    """The policy clamp is for numbers; values that have names each mean something else.

    The value next to an unknown one is no better than any other, and a text that was cut says
    something else. Such a message is dropped and counted. An assignment that asks for clamp by
    itself expects something else. The policy of a connection may be clamp: it counts for the
    numbers.

    Bad: `outOfRange="clamp"` with a target whose value set lists CLOSED and OPEN

    Good: the same with `outOfRange="dropMessage"`
    """
    for each in subject.instances("bridge.AttributeMap"):
        for assignment in _assignments(subject, each, to_ros=False):
            if assignment.outOfRange.name != "clamp":
                continue
            target = jaus_attribute(each.message, assignment.target)
            if not isinstance(target, Attribute):
                continue
            message = ""
            if target.named:
                message = f"the values of '{assignment.target}' have names, none is nearest"
            elif target.kind in (TEXT, OCTETS):
                message = f"'{assignment.target}' is {target.name}, which is never cut"
            if message:
                yield Finding(assignment, message, "outOfRange", "dropField, dropMessage or error")


def _assignments(subject: Subject, attribute_map: Any, *, to_ros: bool) -> list[Any]:
    """The field assignments of a direction, as far as they and both ends were read."""
    if not subject.is_intact(attribute_map.message, attribute_map.type):
        return []
    found = attribute_map.toRos if to_ros else attribute_map.toJaus
    return [
        each
        for each in found
        if subject.is_intact(each)
        and each.target is not None
        and class_name(each) == "FieldAssignment"
    ]


def _must_be_there(attribute_map: Any, assignment: Any, *, to_ros: bool) -> bool:
    if to_ros:
        return True
    target = jaus_attribute(attribute_map.message, assignment.target)
    return isinstance(target, Attribute) and target.kind in _LIMITED and not target.optional


def _connection_findings(subject: Subject, connection: Any) -> Iterator[Finding]:
    to_ros = connection.direction.name == "jausToRos"
    if to_ros:
        message = f"'{connection.name}' makes ROS messages, whose fields are never left out"
        yield Finding(connection, message, "outOfRange", _HINT)
        return
    found = [
        each
        for each in _assignments(subject, connection.map, to_ros=False)
        if each.outOfRange.name == "asConnection"
        and _must_be_there(connection.map, each, to_ros=False)
    ]
    if found:
        names = ", ".join(f"'{each.target}'" for each in found[:_MOST_NOTES])
        more = " ..." if len(found) > _MOST_NOTES else ""
        message = f"'{connection.name}' leaves out fields that are not optional: {names}{more}"
        notes = tuple(Note(each, f"'{each.target}'", "target") for each in found[:_MOST_NOTES])
        hint = f"give these assignments {_HINT}"
        yield Finding(connection, message, "outOfRange", hint, notes)


RULES = (left_out_fields, clamped_values)
