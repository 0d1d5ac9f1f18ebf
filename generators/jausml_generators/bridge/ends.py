"""Ends of connections as Python text: topics, JAUS peers, joined topics and reports."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass

from jausml.generation.literals import python_literal, python_string
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics.connections.reports import JoinedReport, joined_reports
from jausml.language.semantics.connections.topics import policies, reliability
from jausml.language.semantics.directions import is_to_ros
from jausml.language.wire.kinds import PRESENCE_VECTOR
from jausml_generators.common.components import address_call, query_for, search_call
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import call


@dataclass(frozen=True)
class JoinView:
    """A further topic that a translation takes values from."""

    connection: bridge.Connection
    join: bridge.Join
    name: str
    type_name: str

    @property
    def model_name(self) -> str:
        """Its name in the model."""
        return str(self.join.name)

    @property
    def type(self) -> ros.MessageType:
        """The ROS type in the model."""
        return self.join.type

    @property
    def topics(self) -> tuple[bridge.Topic, ...]:
        """The topics that feed it."""
        return tuple(topic for topic in self.connection.topics if topic.join is self.join)

    @property
    def argument(self) -> str:
        """The join as an argument of the runtime class, as Python text."""
        topics = list_of(topic_call(self.connection, topic) for topic in self.topics)
        arguments = [python_string(self.model_name), self.type_name, topics]
        return call("Join", *arguments, *_staleness(self.join))


def _staleness(join: bridge.Join | bridge.ReportJoin) -> list[str]:
    """Returns the arguments on the staleness of a join, and its effect."""
    drops = ["drop=True"] if join.whenStale.name == "dropMessage" else []
    return [f"freshness={python_literal(float(join.freshness))}", *drops]


def topic_call(connection: bridge.Connection, topic: bridge.Topic) -> str:
    """Returns a topic with the policies that differ from the usual ones."""
    usual = {"reliability": "reliable", **policies(None)}
    own = {"reliability": reliability(connection, topic), **policies(topic.qos)}
    stated = [
        f"{snake_case(feature)}={python_literal(value)}"
        for feature, value in own.items()
        if value != usual[feature]
    ]
    arguments = [python_string(topic.name)]
    if stated:
        arguments.append(call("Qos", *stated))
    return call("Topic", *arguments)


def list_of(items: Iterable[str]) -> str:
    """Returns a list of what is Python text already."""
    return f"[{', '.join(items)}]"


def query_call(query: MessageView, report: MessageView | None, fields: Container[str]) -> str:
    """Returns a query whose presence vector names the fields that are read.

    Args:
        report: The report, if something of it is read.
    """
    presence = query.find(PRESENCE_VECTOR)
    if not presence or report is None:
        return call(query.class_name)
    bits = (member.bit for member in report.body.members if member.jaus_name in fields)
    return call(query.class_name, f"{presence[0].attribute}=0x{sum(bits):04X}")


def query_of(connection: bridge.Connection) -> jaus.MessageDef | None:
    """Returns the query for the report of a connection; None for single messages.

    Raises:
        GenerationError: Neither the service of the report nor another of the sender has one.
    """
    if connection.exchange.name == "message":
        return None
    if connection.query is not None:
        return connection.query
    report = connection.map.message
    to_ros = is_to_ros(connection)
    senders = connection.peers if to_ros else [connection.eContainer()]
    services = [provide for sender in senders if sender is not None for provide in sender.provides]
    if to_ros and connection.search is not None:
        services += connection.search.services
    return query_for(report, services, f"connection '{connection.name}'")


def peers_of(
    connection: bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection,
) -> str:
    """Returns the components at the other end of a connection, or how they are found, as Python."""
    if connection.search is not None:
        return search_call(connection.search)
    return list_of(map(address_call, connection.peers))


def priority_of(
    connection: bridge.Connection | bridge.RosServiceConnection,
) -> list[tuple[str, str]]:
    """Returns the argument of the priority of a connection; none for the usual one."""
    if connection.priority.name == "standard":
        return []
    names = {"low": "LOW", "high": "HIGH", "safetyCritical": "SAFETY_CRITICAL"}
    return [("priority", f"Priority.{names[connection.priority.name]}")]


@dataclass(frozen=True)
class ReportJoinView:
    """A further report that a translation takes values from.

    Args:
        report: The report, and where it comes from.
        query: The query as it is asked, as Python text; empty when nothing is asked.
    """

    report: JoinedReport
    name: str
    message: MessageView
    query: str

    @property
    def join(self) -> bridge.ReportJoin:
        """The join in the model."""
        return self.report.join

    @property
    def model_name(self) -> str:
        """Its name in the model."""
        return str(self.join.name)

    @property
    def type_name(self) -> str:
        """Name of its class in the generated modules."""
        return self.message.class_name

    @property
    def type(self) -> jaus.MessageDef:
        """The report in the model."""
        return self.join.message

    @property
    def rate(self) -> float | None:
        """Reports each second that are asked for, 0 for as many as the frequency of the bridge.

        None when nothing is asked for, or every change.
        """
        return self.report.stated_rate if self.report.rate else None

    @property
    def named_peers(self) -> list[str]:
        """Addresses of the JAUS components that send it, where they are stated for it."""
        source = self.report.source
        return [] if source is None else [str(peer.address) for peer in source.peers]

    @property
    def argument(self) -> str:
        """The join as an argument of the runtime class, as Python text."""
        arguments = [python_string(self.model_name), self.type_name]
        if self.query:
            arguments.append(f"query={self.query}")
        if self.rate is not None:
            arguments.append(f"rate={python_literal(self.rate)}")
        if self.report.exchange == "query":
            arguments.append("is_asked=True")
        if self.report.source is not None and self.report.source.peers:
            peers = ", ".join(map(address_call, self.report.source.peers))
            arguments.append(f"peers=[{peers}]")
        return call("ReportJoin", *arguments, *_staleness(self.join))


def messages_of_joins(connection: bridge.Connection) -> Iterator[jaus.MessageDef]:
    """Yields the joined reports of a connection and the queries for them.

    Raises:
        GenerationError: Nobody takes a query for a report.
    """
    for report in joined_reports(connection):
        yield report.join.message
        query = query_of_join(report)
        if query is not None:
            yield query


def query_of_join(report: JoinedReport) -> jaus.MessageDef | None:
    """Returns the query for a joined report; None when it is not asked for.

    Raises:
        GenerationError: Neither its service nor another of who sends it has one.
    """
    if report.exchange == "message":
        return None
    if report.stated_query is not None:
        return report.stated_query
    services = [
        service
        for peer in report.peers
        for service in (peer.services if isinstance(peer, jaus.PeerSearch) else peer.provides)
    ]
    name = f"'{report.connection.name}.{report.join.name}'"
    return query_for(report.join.message, services, name)
