"""Rules about freshness: how long a report repeats a topic that has fallen silent."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.reports import freshness_of, holds_state, is_report
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import time_findings
from jausml.language.validation.rule import Finding, rule


@rule(
    "JML455",
    "report that outlives its sensor",
    severity=Severity.WARNING,
    is_decision=True,
    kinds=bridge.Connection,
)
def outlived_sensors(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A report that is made from a ROS topic states the time after which the topic counts as dead.

    Without that time, the last message is reported forever, and a dead sensor looks alive. A topic
    that holds a state, such as a goal or a map, is published once and stays true; state this
    instead.

    Bad: `direction="rosToJaus" exchange="periodicEvent"` where neither the connection nor its map
    has a freshness

    Good: the same with `freshness="1.0"`, or with `whenStale="keep"` where the topic holds a state
    """
    if connection.map is None or not subject.is_intact(connection, connection.map):
        return
    if not is_report(connection) or holds_state(connection) or connection.silenceTimeout:
        return
    if not freshness_of(connection):
        message = f"'{connection.name}' reports the last message of its topic forever"
        hint = "state a freshness, or whenStale keep where the topic holds a state"
        yield Finding(connection, message, "freshness", hint)


@rule("JML456", "freshness used wrongly", kinds=bridge.AttributeMap, needs=("name",))
def freshness_range(_: Subject, attribute_map: bridge.AttributeMap) -> Iterator[Finding]:
    """A freshness is a time in seconds, in a connection that makes a report from ROS topics.

    Other connections pass each message on when it comes; silenceTimeout says what happens when
    none comes. A report with a silenceTimeout needs no freshness: both say when a topic is dead.

    Bad: `direction="jausToRos" freshness="1.0"`

    Good: `direction="rosToJaus" exchange="periodicEvent" freshness="1.0"`
    """
    yield from time_findings(attribute_map, "freshness")


@freshness_range.also(bridge.Connection)
def _freshness_range_connection(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    yield from time_findings(connection, "freshness")
    if connection.freshness > 0 and not is_report(connection):
        message = f"'{connection.name}' makes no report of ROS topics"
        yield Finding(connection, message, "freshness", "silenceTimeout is for other connections")
    elif connection.freshness > 0 and connection.silenceTimeout:
        message = f"'{connection.name}' has a freshness and a silenceTimeout"
        yield Finding(connection, message, "freshness", "keep one of them")
