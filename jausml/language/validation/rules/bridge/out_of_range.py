"""Rules about values that the target of an assignment cannot carry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.paths.attributes import NUMBER, OCTETS, TEXT, Attribute, Found
from jausml.language.semantics.paths.directions import direction_of, directions
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.paths.scopes import Placed
    from jausml.language.semantics.subject import Subject

_DROP_FIELD = "dropField"
_HINT = "clamp, dropMessage or error"
_LIMITED = (NUMBER, TEXT, OCTETS)
_MOST_NOTES = 3


@rule("JML417", Severity.ERROR, "field that cannot be left out")
def left_out_fields(subject: Subject) -> Iterator[Finding]:
    """The policy dropField is for optional fields of JAUS messages.

    A JAUS message always has its other fields, and a ROS message has all of its fields: instead of
    being left out, they would carry a number that nobody measured. The policy of a connection
    applies to the assignments of its direction that state none.

    Bad: `outOfRange="dropField"` with `target="Speed"` of SetTravelSpeed, which has no optional
    field

    Good: the same with `outOfRange="dropMessage"`
    """
    for direction in directions(subject):
        for placed in direction.of_kind(bridge.FieldAssignment):
            if placed.assignment.outOfRange.name != _DROP_FIELD:
                continue
            path = _never_left_out(placed)
            if path is not None:
                message = f"'{path}' is no optional JAUS field, it is never left out"
                yield Finding(placed.assignment, message, "outOfRange", _HINT)
    for connection in subject.instances(bridge.Connection):
        if connection.outOfRange.name == _DROP_FIELD and connection.map is not None:
            yield from _connection_findings(subject, connection)


@rule("JML418", Severity.WARNING, "values that cannot be clamped")
def clamped_values(subject: Subject) -> Iterator[Finding]:
    """The policy clamp is for numbers; values that have names each mean something else.

    The value next to an unknown one is no better than any other, and a text that is cut has another
    meaning. Such a message is dropped and counted, which an assignment that states clamp itself
    does not expect. The policy of a connection may be clamp, because it applies to the numbers.

    Bad: `outOfRange="clamp"` with a target whose value set lists CLOSED and OPEN

    Good: the same with `outOfRange="dropMessage"`
    """
    for direction in directions(subject):
        if direction.to_ros:
            continue
        for placed in direction.of_kind(bridge.FieldAssignment):
            if placed.assignment.outOfRange.name != "clamp":
                continue
            for path, target in placed.targets:
                message = _unclampable(path, target)
                if message:
                    hint = "dropField, dropMessage or error"
                    yield Finding(placed.assignment, message, "outOfRange", hint)


def _unclampable(path: str, target: Found) -> str:
    if not isinstance(target, Attribute):
        return ""
    if target.named:
        return f"the values of '{path}' have names, none is nearest"
    if target.kind in (TEXT, OCTETS):
        return f"'{path}' is {target.name}, which is never cut"
    return ""


def _never_left_out(placed: Placed[bridge.FieldAssignment]) -> str | None:
    """The first target that is there in any case, None when all may be left out."""
    for path, target in placed.targets:
        if placed.scope.to_ros:
            return path
        if isinstance(target, Attribute) and target.kind in _LIMITED and not target.optional:
            return path
    return None


def _connection_findings(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    to_ros = connection.direction.name == "jausToRos"
    if to_ros:
        message = f"'{connection.name}' makes ROS messages, whose fields are never left out"
        yield Finding(connection, message, "outOfRange", _HINT)
        return
    direction = direction_of(subject, connection.map, to_ros=False)
    if direction is None:
        return
    found = [
        placed.assignment
        for placed in direction.of_kind(bridge.FieldAssignment)
        if placed.assignment.outOfRange.name == "asConnection"
        and _never_left_out(placed) is not None
    ]
    if found:
        names = ", ".join(f"'{each.target}'" for each in found[:_MOST_NOTES])
        more = " ..." if len(found) > _MOST_NOTES else ""
        message = f"'{connection.name}' leaves out fields that are not optional: {names}{more}"
        notes = tuple(Note(each, f"'{each.target}'", "target") for each in found[:_MOST_NOTES])
        hint = f"give these assignments {_HINT}"
        yield Finding(connection, message, "outOfRange", hint, notes)
