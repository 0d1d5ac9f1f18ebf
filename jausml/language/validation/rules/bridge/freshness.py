"""Rules about reports whose ROS topic falls silent."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.freshness import freshness_of, holds_state, is_report
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject


@rule("JML455", Severity.WARNING, "report that outlives its sensor")
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
