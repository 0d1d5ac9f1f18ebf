"""Views of joined reports: further JAUS reports from which a translation takes values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml.generation.literals import python_literal, python_string
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.connections.reports import joined_reports
from jausml_generators.common.components import address_call, query_for, with_inherited
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import bridge
    from jausml.language.semantics.connections.reports import JoinedReport
    from jausml_generators.python.codec.messages import MessageView


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
        """Reports each second that are asked for; None when nothing is, or every change."""
        return self.report.rate or None

    @property
    def named_peers(self) -> list[str]:
        """Addresses of the JAUS components that send it, where they are stated for it."""
        source = self.report.source
        return [] if source is None else [str(each.address) for each in source.peers]

    @property
    def argument(self) -> str:
        """The join as an argument of the runtime class, as Python text."""
        found = [python_string(self.model_name), self.type_name]
        if self.query:
            found.append(f"query={self.query}")
        if self.rate is not None:
            found.append(f"rate={python_literal(self.rate)}")
        if self.report.exchange == "query":
            found.append("is_asked=True")
        if self.report.source is not None and self.report.source.peers:
            peers = ", ".join(map(address_call, self.report.source.peers))
            found.append(f"peers=[{peers}]")
        found.append(f"freshness={python_literal(float(self.join.freshness))}")
        if self.join.whenStale.name == "dropMessage":
            found.append("drop=True")
        return call("ReportJoin", *found)


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
    own = report.join.message.eContainer()
    provided = with_inherited(services)
    query = query_for(report.join.message, provided if own is None else [own, *provided])
    if query is None:
        name = f"{report.connection.name}.{report.join.name}"
        raise GenerationError(f"'{name}': no query for {report.join.message.name}")
    return query
