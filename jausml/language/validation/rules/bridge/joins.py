"""Rules about joined topics, and about connections that do not pass all messages on."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.limits import (
    GREATEST_DECIMATION,
    LEAST_PACE,
    LONGEST_FRESHNESS,
    LONGEST_TIME,
    SHORTEST_TIME,
)
from jausml.language.semantics.connections.reports import freshness_of, holds_state, is_report
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import is_sound, source_paths
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import time_findings
from jausml.language.validation.rule import Finding, Note, rule


@rule("JML442", "join used wrongly", kinds=bridge.AttributeMap)
def joins(_: Subject, attribute_map: bridge.AttributeMap) -> Iterator[Finding]:
    """A join has a unique name, a time after which it is stale, and a topic that feeds it.

    Source paths begin with the name of the join, so it differs from the fields of the main type and
    from other joins. A connection from ROS to JAUS has a topic for each join of its map, but for
    one with `whenStale` leave, whose fields are absent then; and one or more without a join, which
    the map is for. From JAUS to ROS there is nothing to join.

    Bad: a map with the join imu, and a connection whose one topic has no join

    Good: `<topics name="fix"/><topics name="imu/data" join="imu"/>`
    """
    fields = (
        {field.name for field in attribute_map.type.fields}
        if attribute_map.type is not None
        else set()
    )
    used = first_names(attribute_map.toJaus)
    yield from join_findings(attribute_map.joins, "join", "type", fields, used)


@joins.also(bridge.Connection)
def _joins_connection(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    if connection.map is not None and subject.is_intact(connection):
        yield from _topic_findings(connection)


def join_findings(
    joins_of_map: Iterable[bridge.Join | bridge.ReportJoin],
    kind: str,
    main: str,
    fields: set[str],
    used: set[str],
) -> Iterator[Finding]:
    """Yields the findings about the joins of a map, of topics or of reports.

    Args:
        joins_of_map: All joins of the kind that the map has.
        kind: How findings call one: `join` or `report join`.
        main: How findings call what is not joined: `type` or `message`.
        fields: The names of its fields.
        used: The first names of the source paths of the map.
    """
    first_of_name: dict[str, bridge.Join | bridge.ReportJoin] = {}
    for join in joins_of_map:
        yield from _single_join_findings(join, kind, main, fields, used)
        first = first_of_name.setdefault(str(join.name), join)
        if first is not join:
            note = Note(first, "the other one", "name")
            message = f"two {kind}s are named '{join.name}'"
            yield Finding(join, message, "name", related=(note,))


def _single_join_findings(
    join: bridge.Join | bridge.ReportJoin, kind: str, main: str, fields: set[str], used: set[str]
) -> Iterator[Finding]:
    if not SHORTEST_TIME <= join.freshness <= LONGEST_FRESHNESS:
        message = f"freshness {join.freshness:g} of '{join.name}' is not"
        message += f" {SHORTEST_TIME:g} to {LONGEST_FRESHNESS:g} s"
        yield Finding(join, message, "freshness")
    if join.name in fields:
        message = f"{kind} '{join.name}' has the name of a field of the main {main}"
        yield Finding(join, message, "name", "choose another name")
    elif join.name not in used:
        message = f"no assignment takes anything of {kind} '{join.name}'"
        yield Finding(join, message, "name", severity=Severity.WARNING)


def _topic_findings(connection: bridge.Connection) -> Iterator[Finding]:
    known = list(connection.map.joins)
    is_to_jaus = not is_to_ros(connection)
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
    if connection.topics and all(topic.join is not None for topic in connection.topics):
        message = f"'{connection.name}' has no topic without a join, which the map is for"
        yield Finding(connection, message, "topics")
    for join in known:
        is_needed = join.whenStale.name != "leave"
        if is_needed and all(topic.join is not join for topic in connection.topics):
            message = f"no topic of '{connection.name}' feeds join '{join.name}'"
            note = Note(join, f"'{join.name}'", "name")
            hint = f"add a topic that has the join {join.name}"
            yield Finding(connection, message, "topics", hint, (note,))


def first_names(assignments: Iterable[bridge.Assignment]) -> set[str]:
    """Returns the first names of source paths, those in lists included: of joins and of fields."""
    names: set[str] = set()
    for assignment in assignments:
        names |= {path.lstrip("/").partition(".")[0] for path in source_paths(assignment)}
        if isinstance(assignment, bridge.ListAssignment):
            names |= first_names(assignment.assignments)
    return names


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


@rule("JML490", "shaping out of range", kinds=bridge.Connection, needs=("name",))
def shaping_range(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A maxRate is 0 or at least 0.001 Hz, a decimation 1 to 1000000, an ageLimit 0 to 3600 s.

    Bad: `decimation="0"`

    Good: `decimation="5"`
    """
    rate, seconds = connection.maxRate, connection.ageLimit
    if rate != 0 and not (math.isfinite(rate) and rate >= LEAST_PACE):
        message = f"maxRate {rate:g} of '{connection.name}' is neither 0 nor {LEAST_PACE:g} or more"
        yield Finding(connection, message, "maxRate")
    if not 1 <= connection.decimation <= GREATEST_DECIMATION:
        message = f"decimation {connection.decimation} of '{connection.name}' is not 1 to"
        yield Finding(connection, f"{message} {GREATEST_DECIMATION}", "decimation")
    if not 0 <= seconds <= LONGEST_TIME:
        message = f"ageLimit {seconds:g} of '{connection.name}' is not 0 to {LONGEST_TIME:g} s"
        yield Finding(connection, message, "ageLimit")


@rule("JML491", "shaping of what is asked for", kinds=bridge.Connection, condition=is_sound)
def queries_unshaped(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection that uses queries determines with its rate how many messages come.

    Bad: `direction="jausToRos" exchange="query" rate="10" maxRate="5"`

    Good: the same with `rate="5"` alone
    """
    if connection.exchange.name != "query" or not is_to_ros(connection):
        return
    for feature, is_said in (
        ("maxRate", connection.maxRate != 0),
        ("decimation", connection.decimation != 1),
    ):
        if is_said:
            message = f"'{connection.name}' asks as often as its rate says"
            yield Finding(connection, message, feature, f"leave {feature} out, and state the rate")


@rule(
    "JML492",
    "maxRate that changes nothing",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def rates_reached(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A maxRate is below the rate at which messages of a periodic event come.

    That is the rate of the connection, or the frequency of the bridge, of each of its peers, and
    the part of it that the decimation leaves.

    Bad: `exchange="periodicEvent" rate="10" maxRate="20"`

    Good: `exchange="periodicEvent" rate="10"`
    """
    owner = connection.eContainer()
    if connection.exchange.name != "periodicEvent" or not is_to_ros(connection):
        return
    if not 0 < connection.maxRate < math.inf or connection.search is not None or owner is None:
        return
    rate = (
        (connection.rate or owner.frequency)
        * max(len(connection.peers), 1)
        / max(connection.decimation, 1)
    )
    if connection.maxRate >= rate:
        message = f"no more than {rate:g} messages of '{connection.name}' come each second"
        yield Finding(connection, message, "maxRate", "leave maxRate out")


@rule(
    "JML493",
    "shaping that loses the last word",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def last_words_kept(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A message that stays valid until the next one always passes.

    A decimation passes one of several messages, and the last one of a command, of a change or of a
    state may be another. A maxRate does not lose it. A state is as old as its last change; an
    ageLimit would treat it as late.

    Bad: `decimation="10"` for SetWrenchEffort, or for an everyChangeEvent

    Good: the same with `maxRate="5"`
    """
    changes = connection.exchange.name == "everyChangeEvent" and is_to_ros(connection)
    is_command = stops.carries_commands(connection)
    is_state = (
        changes or (is_report(connection) and holds_state(connection)) or _is_latched(connection)
    )
    if connection.decimation > 1 and (is_command or is_state):
        message = f"the decimation of '{connection.name}' may leave its last message out"
        yield Finding(connection, message, "decimation", "state a maxRate")
    if connection.ageLimit > 0 and is_state and not is_command:
        message = f"'{connection.name}' holds a state, whose age does not make it wrong"
        yield Finding(connection, message, "ageLimit", "leave ageLimit out")


def _is_latched(connection: bridge.Connection) -> bool:
    return not is_to_ros(connection) and any(
        topic.join is None and topic.qos is not None and topic.qos.durability.name != "volatile"
        for topic in connection.topics
    )
