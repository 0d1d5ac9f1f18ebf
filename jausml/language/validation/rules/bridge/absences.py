"""The rule about sources that may have no value: what becomes of their targets."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.steps import knows_unknown
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP, Attribute
from jausml.language.semantics.paths.scopes import Direction, Placed
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_Assignment: TypeAlias = bridge.FieldAssignment | bridge.ListAssignment
_Placed: TypeAlias = Placed[_Assignment]
_Join: TypeAlias = bridge.Join | bridge.ReportJoin
_UNSTATED = "unstated"


@rule("JML459", "value that would be made up", severity=Severity.WARNING, kinds=Direction)
def made_up(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """What becomes of a target without its source is stated, or the target can say it too.

    A source may have no value: JAUS leaves out an optional field, has another option or a shorter
    list; in ROS a marker says so, such as NaN, a status below 0 or a stamp of 0, or a sequence is
    too short for the path; a join with `whenStale="leave"` is silent.

    An optional JAUS field is left out then, a ROS field takes the value of its marker, a text or a
    sequence is empty. All else would keep its default: a velocity of 0 says that the vehicle
    stands, a position of 0 puts it on the origin. What occupancy_to_cost makes of an unknown
    occupancy is a cost too.

    In maps of the library this is an error. The rule takes the place of JML457 and JML496.

    Bad: `target="twist.linear.x" source="Velocity_X"` where Velocity_X is optional

    Good: the same with `whenAbsent="dropMessage"`, with `useDefault` and a `defaultValue`, with
    `receptionTime` for an instant, or with `leave` where the default is meant
    """
    for placed in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment):
        assignment = placed.assignment
        if assignment.whenAbsent.name == _UNSTATED and not knows_unknown(assignment):
            severity = Severity.ERROR if subject.model.is_library(assignment) else None
            yield from _made_up(placed, severity)


def _made_up(placed: _Placed, severity: Severity | None) -> Iterator[Finding]:
    """Yields the first target that would be made up, and no other one of the same assignment."""
    for path, target in placed.targets:
        # An instant of 0 may mean "none", but readers take it for 1970, or for the latest.
        if not isinstance(target, Attribute) or (target.says_unknown and target.kind != TIME):
            continue
        for source, attribute in placed.sources:
            if isinstance(attribute, Attribute) and attribute.may_lack:
                yield _without_source(placed.assignment, path, target, source, severity)
                return
            join = _lenient_join(placed, source)
            if join is not None:
                yield _without_join(placed.assignment, path, join, severity)
                return


def _without_source(
    assignment: _Assignment, path: str, target: Attribute, source: str, severity: Severity | None
) -> Finding:
    choices = "dropMessage, useDefault with a defaultValue, or leave"
    if target.kind in (TIME, TIME_STAMP):
        choices = "receptionTime, dropMessage or leave"
    return Finding(
        assignment,
        f"'{path}' would be made up without '{source}'",
        feature="target",
        hint=f"state whenAbsent: {choices}",
        severity=severity,
    )


def _without_join(
    assignment: _Assignment, path: str, join: _Join, severity: Severity | None
) -> Finding:
    return Finding(
        assignment,
        f"'{path}' would be made up without a fresh '{join.name}'",
        feature="target",
        hint="give the join whenStale dropMessage, or the assignment a whenAbsent",
        related=(Note(join, f"join '{join.name}'", feature="name"),),
        severity=severity,
    )


def _lenient_join(placed: _Placed, path: str) -> _Join | None:
    """Returns the join that a source path begins with, if it leaves its targets while silent."""
    scope = placed.scope
    if scope.is_nested and not path.startswith("/"):
        return None
    name = path.lstrip("/").partition(".")[0]
    joins = scope.map.reportJoins if scope.to_ros else scope.map.joins
    lenient = (join for join in joins if join.name == name and join.whenStale.name == "leave")
    return next(lenient, None)
