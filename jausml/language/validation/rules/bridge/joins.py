"""Rules about joins: further topics from which a map takes values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.limits import LONGEST_FRESHNESS, SHORTEST_TIME
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import source_paths
from jausml.language.semantics.subject import Subject
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
