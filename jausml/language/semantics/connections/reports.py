"""Reports of bridges: where joined ones come from, and how long the message of a topic stands."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.services import (
    Provider,
    find_input,
    inputs,
    peers_of,
    query_name,
)
from jausml.language.semantics.paths.scopes import flattened, outer_scope, source_paths


@dataclass(frozen=True)
class JoinedReport:
    """A joined report of a connection."""

    connection: bridge.Connection
    join: bridge.ReportJoin
    source: bridge.ReportSource | None

    @property
    def exchange(self) -> str:
        """Literal of Exchange."""
        return "periodicEvent" if self.source is None else str(self.source.exchange.name)

    @property
    def has_own_peers(self) -> bool:
        """Whether the connection states its senders."""
        return self.source is not None and bool(self.source.peers)

    @property
    def peers(self) -> list[Provider]:
        """The senders: those that are named, or whatever the connection searches for."""
        if self.source is not None and self.source.peers:
            return list(self.source.peers)
        return peers_of(self.connection)

    @property
    def rate(self) -> float:
        """Reports each second that are asked for; 0 when nothing is, or every change."""
        if self.exchange not in {"periodicEvent", "query"}:
            return 0.0
        owner = self.connection.eContainer()
        return self.stated_rate or float(owner.frequency if owner is not None else 0.0)

    @property
    def stated_rate(self) -> float:
        """The rate that is stated for it or its connection; 0 for that of the bridge."""
        own = self.source.rate if self.source is not None else 0.0
        return float(own or self.connection.rate)

    @property
    def stated_query(self) -> jaus.MessageDef | None:
        """The query that the connection states."""
        return self.source.query if self.source is not None else None

    def query_of(self, provider: Provider) -> jaus.MessageDef | None:
        """Returns the query among the inputs of a provider; None when it takes none."""
        if self.stated_query is not None:
            return find_input(self.stated_query, provider)
        wanted = query_name(self.join.message)
        return next((message for message in inputs(provider) if message.name == wanted), None)


def joined_reports(connection: bridge.Connection) -> list[JoinedReport]:
    """Returns the joined reports of a connection; none from ROS to JAUS."""
    if not is_to_ros(connection):
        return []
    # Of two sources of one join the first counts.
    stated = {source.join: source for source in reversed(connection.sources)}
    return [JoinedReport(connection, join, stated.get(join)) for join in connection.map.reportJoins]


def report_join_of(
    path: str, joins: Iterable[bridge.ReportJoin]
) -> tuple[bridge.ReportJoin | None, str]:
    """Returns the join that a source path starts with, and the rest of the path.

    Returns:
        None and the path when it starts with none; `.` is the whole report.
    """
    first, _, rest = path.lstrip("/").partition(".")
    join = next((candidate for candidate in joins if candidate.name == first), None)
    return (None, path) if join is None else (join, rest or ".")


def requested_fields(owner: bridge.Bridge) -> Mapping[jaus.MessageDef, frozenset[str]]:
    """Returns by report the fields that some connection of a bridge reads."""
    incoming = (connection.map for connection in owner.bridgeConnections if is_to_ros(connection))
    fields: dict[jaus.MessageDef, set[str]] = defaultdict(set)
    for attribute_map in dict.fromkeys(incoming):
        for path in _read_paths(attribute_map):
            join, rest = report_join_of(path, attribute_map.reportJoins)
            message = attribute_map.message if join is None else join.message
            fields[message].add(rest.split(".")[0].partition("[")[0])
    return {message: frozenset(names) for message, names in fields.items()}


def requested_in(map_: bridge.AttributeMap | None) -> frozenset[str]:
    """Returns the fields of its message that a map reads; none without a map."""
    paths = () if map_ is None else _read_paths(map_)
    return frozenset(path.split(".")[0].partition("[")[0] for path in paths)


def _read_paths(map_: bridge.AttributeMap) -> Iterator[str]:
    """Yields the source paths that start at the message, those in lists included."""
    for placed in flattened(map_.toRos, outer_scope(map_, to_ros=True)):
        for path in source_paths(placed.assignment):
            if not placed.scope.is_nested:
                yield path
            elif path.startswith("/"):
                yield path[1:]


def is_report(connection: bridge.Connection) -> bool:
    """Whether a connection makes a JAUS report of ROS topics, which queries and events serve."""
    return not is_to_ros(connection) and connection.exchange.name != "message"


def holds_state(connection: bridge.Connection) -> bool:
    """Whether the topics hold a state, whose last value is reported for as long as it takes."""
    policy = connection.whenStale.name
    if policy == "asMap" and connection.map is not None:
        policy = connection.map.whenStale.name
    return policy == "keep"


def freshness_of(connection: bridge.Connection) -> float:
    """Returns after how many seconds a message is too old to be reported; 0 for never.

    A silence time-out says the same: with a safe value that stands in, or without.
    """
    if not is_report(connection) or holds_state(connection) or connection.silenceTimeout:
        return 0.0
    stated = connection.freshness
    if not stated and connection.map is not None:
        stated = connection.map.freshness
    return float(stated)


def passed_rate(connection: bridge.Connection, hertz: float) -> float:
    """Returns how many messages pass each second at most."""
    hertz /= max(connection.decimation, 1)
    return min(hertz, connection.maxRate) if connection.maxRate > 0 else hertz
