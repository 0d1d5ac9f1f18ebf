"""Rules about joined topics, and how long messages of topics hold."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.freshness import freshness_of, holds_state, is_report
from jausml.language.semantics.paths.attributes import Attribute
from jausml.language.semantics.paths.directions import directions
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import source_paths
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.semantics.paths.scopes import Placed
    from jausml.language.semantics.subject import Subject


@rule("JML442", Severity.ERROR, "join used wrongly")
def joins(subject: Subject) -> Iterator[Finding]:
    """A join has a unique name, a time after which it is stale, and a topic that feeds it.

    Source paths begin with the name of the join, so it differs from the fields of the main type. A
    connection from ROS to JAUS has one topic for each join of its map, and one or more without a
    join, which the map is for. From JAUS to ROS there is nothing to join.

    Bad: a map with the join imu, and a connection whose one topic has no join

    Good: `<topics name="fix"/><topics name="imu/data" join="imu"/>`
    """
    for each in subject.instances(bridge.AttributeMap):
        fields = {field.name for field in each.type.fields} if each.type is not None else set()
        used = {path.lstrip("/").partition(".")[0] for path in _paths(each.toJaus)}
        for join in each.joins:
            yield from _join_findings(join, fields, used)
    for connection in subject.instances(bridge.Connection):
        if connection.map is not None and subject.is_intact(connection):
            yield from _topic_findings(connection)


@rule("JML457", Severity.ERROR, "mandatory field that would be made up")
def made_up(subject: Subject) -> Iterator[Finding]:
    """A mandatory JAUS field whose source may lack has a default, or the message is dropped.

    While a joined topic is silent, `whenStale="leave"` leaves out the optional fields that it
    feeds, and so does a sequence that is too short for an element that a path names. A mandatory
    field is sent anyway, and would be a 0 that nobody measured.

    Bad: `target="Attitude_RMS"` from the join imu, where Attitude_RMS is mandatory

    Good: the same with `whenStale="dropMessage"` of the join, or with `whenAbsent="dropMessage"` or
    `whenAbsent="useDefault"` and a `defaultValue` of the assignment
    """
    for direction in directions(subject):
        if direction.to_ros:
            continue
        lenient = {
            each.name: each for each in direction.map.joins if each.whenStale.name == "leave"
        }
        for placed in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment):
            if placed.assignment.whenAbsent.name == "leave":
                yield from _made_up(placed, lenient)


def _made_up(
    placed: Placed[bridge.FieldAssignment | bridge.ListAssignment], lenient: dict[str, bridge.Join]
) -> Iterator[Finding]:
    for source in source_paths(placed.assignment):
        join = lenient.get(source.lstrip("/").partition(".")[0])
        found = placed.scope.find_source(source)
        if join is None and not (isinstance(found, RosPlace) and found.in_sequence):
            continue
        lacks = f"a fresh '{join.name}'" if join is not None else f"'{source}'"
        hint = "give the assignment a whenAbsent"
        if join is not None:
            hint = "give the join whenStale dropMessage, or the assignment a whenAbsent"
        notes = () if join is None else (Note(join, f"join '{join.name}'", "name"),)
        for path, target in placed.targets:
            if isinstance(target, Attribute) and not target.optional:
                message = f"'{path}' is mandatory: without {lacks} it would be made up"
                yield Finding(placed.assignment, message, "target", hint, notes)
        return


def _join_findings(join: bridge.Join, fields: set[str], used: set[str]) -> Iterator[Finding]:
    if not (math.isfinite(join.freshness) and join.freshness > 0):
        message = f"freshness {join.freshness:g} of '{join.name}' is no time above 0"
        yield Finding(join, message, "freshness")
    if join.name in fields:
        message = f"join '{join.name}' has the name of a field of the main type"
        yield Finding(join, message, "name", "choose another name")
    elif join.name not in used:
        message = f"no assignment takes anything of join '{join.name}'"
        yield Finding(join, message, "name", severity=Severity.WARNING)


def _topic_findings(connection: bridge.Connection) -> Iterator[Finding]:
    known = list(connection.map.joins)
    is_to_jaus = connection.direction.name == "rosToJaus"
    main = [topic for topic in connection.topics if topic.join is None]
    for topic in connection.topics:
        if topic.join is not None and not is_to_jaus:
            message = f"topic '{topic.name}' is published to, it feeds no join"
            yield Finding(topic, message, "join")
        elif topic.join is not None and topic.join not in known:
            message = f"join '{topic.join.name}' is none of map '{connection.map.name}'"
            note = Note(topic.join, f"'{topic.join.name}'", "name")
            yield Finding(topic, message, "join", related=(note,))
    if not is_to_jaus:
        return
    if connection.topics and not main:
        message = f"'{connection.name}' has no topic without a join, which the map is for"
        yield Finding(connection, message, "topics")
    for join in known:
        if all(topic.join is not join for topic in connection.topics):
            message = f"no topic of '{connection.name}' feeds join '{join.name}'"
            note = Note(join, f"'{join.name}'", "name")
            hint = f"add a topic that has the join {join.name}"
            yield Finding(connection, message, "topics", hint, (note,))


def _paths(assignments: Iterable[bridge.Assignment]) -> Iterator[str]:
    for each in assignments:
        yield from source_paths(each)
        if isinstance(each, bridge.ListAssignment):
            yield from _paths(each.assignments)


@rule("JML455", Severity.WARNING, "report that outlives its sensor", is_decision=True)
def outlived_sensors(subject: Subject) -> Iterator[Finding]:
    """A report that is made from a ROS topic states the time after which the topic counts as dead.

    Without that time, the last message is reported forever, and a dead sensor looks alive. A topic
    that holds a state, such as a goal or a map, is published once and stays true; state this
    instead.

    Bad: `direction="rosToJaus" exchange="periodicEvent"` where neither the connection nor its map
    has a freshness

    Good: the same with `freshness="1.0"`, or with `whenStale="keep"` where the topic holds a state
    """
    for connection in subject.instances(bridge.Connection):
        if connection.map is None or not subject.is_intact(connection, connection.map):
            continue
        if not is_report(connection) or holds_state(connection) or connection.silenceTimeout:
            continue
        if not freshness_of(connection):
            message = f"'{connection.name}' reports the last message of its topic forever"
            hint = "state a freshness, or whenStale keep where the topic holds a state"
            yield Finding(connection, message, "freshness", hint)


@rule("JML456", Severity.ERROR, "freshness used wrongly")
def freshness_range(subject: Subject) -> Iterator[Finding]:
    """A freshness is a time in seconds, in a connection that makes a report from ROS topics.

    Other connections pass each message on when it comes; silenceTimeout says what happens when
    none comes. A report with a silenceTimeout needs no freshness: both say when a topic is dead.

    Bad: `direction="jausToRos" freshness="1.0"`

    Good: `direction="rosToJaus" exchange="periodicEvent" freshness="1.0"`
    """
    for each in subject.instances(bridge.AttributeMap, needs=("name",)):
        yield from _time_findings(each)
    for connection in subject.instances(bridge.Connection):
        yield from _time_findings(connection)
        if connection.freshness > 0 and not is_report(connection):
            message = f"'{connection.name}' makes no report of ROS topics"
            yield Finding(
                connection, message, "freshness", "silenceTimeout is for other connections"
            )
        elif connection.freshness > 0 and connection.silenceTimeout:
            message = f"'{connection.name}' has a freshness and a silenceTimeout"
            yield Finding(connection, message, "freshness", "keep one of them")


def _time_findings(element: bridge.AttributeMap | bridge.Connection) -> Iterator[Finding]:
    if not (math.isfinite(element.freshness) and element.freshness >= 0):
        message = f"freshness {element.freshness:g} of '{element.name}' is no time"
        yield Finding(element, message, "freshness")
