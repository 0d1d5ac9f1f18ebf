"""The rule about sources that may have no value: what becomes of their targets."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.steps import knows_unknown
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP, Attribute
from jausml.language.semantics.paths.scopes import Direction, Placed
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_UNSTATED = "unstated"


@rule("JML459", "value that would be made up", severity=Severity.WARNING, kinds=Direction)
def made_up(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """What becomes of a target without its source is stated, or the target can say it too.

    A source may have no value: JAUS leaves out an optional field, has another option or a shorter
    list; in ROS a marker says so, such as NaN, a status below 0 or a stamp of 0, or a sequence is
    too short for the path; a join with `whenStale="leave"` is silent. An optional JAUS field is
    left out then, a ROS field takes the value of its marker, a text or a sequence is empty. All
    else would keep its default: a velocity of 0 says that the vehicle stands, a position of 0 puts
    it on the origin. What occupancy_to_cost makes of an unknown occupancy is a cost too. In maps of
    the library this is an error. JML457 and JML496 are part of it now.

    Bad: `target="twist.linear.x" source="Velocity_X"` where Velocity_X is optional

    Good: the same with `whenAbsent="dropMessage"`, with `useDefault` and a `defaultValue`, with
    `receptionTime` for an instant, or with `leave` where the default is meant
    """
    for placed in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment):
        states = placed.assignment.whenAbsent.name != _UNSTATED
        if not states and not knows_unknown(placed.assignment):
            yield from _made_up(subject, placed)


def _made_up(
    subject: Subject, placed: Placed[bridge.FieldAssignment | bridge.ListAssignment]
) -> Iterator[Finding]:
    for path, target in placed.targets:
        # An instant of 0 may mean "none", but readers take it for 1970, or for the latest.
        if not isinstance(target, Attribute) or (target.says_unknown and target.kind != TIME):
            continue
        for source, attribute in placed.sources:
            may_lack = isinstance(attribute, Attribute) and attribute.may_lack
            join = None if may_lack else _lenient_join(placed, source)
            if not may_lack and join is None:
                continue
            lacks = f"'{source}'" if join is None else f"a fresh '{join.name}'"
            hint = "state whenAbsent: dropMessage, useDefault with a defaultValue, or leave"
            if target.kind in (TIME, TIME_STAMP):
                hint = "state whenAbsent: receptionTime, dropMessage or leave"
            if join is not None:
                hint = "give the join whenStale dropMessage, or the assignment a whenAbsent"
            notes = () if join is None else (Note(join, f"join '{join.name}'", "name"),)
            is_ours = subject.model.is_library(placed.assignment)
            severity = Severity.ERROR if is_ours else None
            message = f"'{path}' would be made up without {lacks}"
            yield Finding(placed.assignment, message, "target", hint, notes, severity)
            return


def _lenient_join(
    placed: Placed[bridge.FieldAssignment | bridge.ListAssignment], path: str
) -> bridge.Join | bridge.ReportJoin | None:
    """The join that a source path begins with, if it leaves its targets while it is silent."""
    scope = placed.scope
    if scope.is_nested and not path.startswith("/"):
        return None
    name = path.lstrip("/").partition(".")[0]
    joins = scope.map.reportJoins if scope.to_ros else scope.map.joins
    return next((e for e in joins if e.name == name and e.whenStale.name == "leave"), None)
