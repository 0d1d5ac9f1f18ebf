"""What clients ask providers for: reports, as events or by queries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections.reports import joined_reports
from jausml.language.semantics.jaus.services import find_query
from jausml.views.analysis.streams import is_single, is_to_ros

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes.system import System
    from jausml.language.semantics.connections.reports import JoinedReport
    from jausml.language.semantics.jaus.services import Provider
    from jausml.views.analysis.streams import Asking

_KINDS = {"everyChangeEvent": "change", "query": "query", "periodicEvent": "periodic"}


@dataclass(frozen=True)
class Request:
    """What a client asks a provider for.

    Attributes:
        exchange: `periodic`, `change` or `query`.
        joined: The join that the report is for; None for what the connection is for.
    """

    client: jaus.Component
    connection: Asking
    message: jaus.MessageDef
    exchange: str
    hertz: float
    joined: JoinedReport | None = None

    @property
    def named_provider(self) -> Provider | None:
        """Whoever is asked first; None when the model names nobody."""
        if self.joined is not None:
            return next(iter(self.joined.peers), None)
        if isinstance(self.connection, bridge.Connection):
            return next(iter(self.connection.peers), self.connection.search)
        return None

    def query_of(self, provider: Provider | None) -> jaus.MessageDef | None:
        """Returns what asks a provider; None when that is not known."""
        if provider is None:
            return None
        if self.joined is not None:
            return self.joined.query_of(provider)
        return find_query(self.connection, provider)


def requests_of(system: System) -> Iterator[tuple[jaus.Component | None, Request]]:
    """Yields whom clients ask for reports, and what for; None is a peer without a name."""
    for owner in system.bridges:
        for each in owner.bridgeConnections:
            if is_to_ros(each) and not is_single(each):
                kind = _KINDS[each.exchange.name]
                rate = 0.0 if kind == "change" else float(each.rate or owner.frequency)
                for peer in peers_of(each):
                    yield peer, Request(owner, each, each.map.message, kind, rate)
            yield from _joined_requests(owner, each)
    for component in (*system.components, *system.bridges):
        for wanted in component.connections:
            if wanted.exchange.name != "oneTime":
                is_periodic = wanted.exchange.name == "periodic"
                rate = float(wanted.rate) if is_periodic else 0.0
                kind = "periodic" if is_periodic else "change"
                yield wanted.provider, Request(component, wanted, wanted.message, kind, rate)


def _joined_requests(
    owner: bridge.Bridge, connection: bridge.Connection
) -> Iterator[tuple[jaus.Component | None, Request]]:
    """Yields whom a connection asks for joined reports, and what for."""
    for report in joined_reports(connection):
        if report.exchange != "message":
            kind, message = _KINDS[report.exchange], report.join.message
            request = Request(owner, connection, message, kind, report.rate, report)
            named: list[jaus.Component | None] = [
                each for each in report.peers if isinstance(each, jaus.Component)
            ]
            yield from ((peer, request) for peer in named or [None])


def peers_of(connection: bridge.Connection) -> list[jaus.Component | None]:
    """Returns who is at the other end; None stands for those that nobody names."""
    return [*connection.peers] or [None]


def alike_requests(requests: list[Request]) -> Iterator[list[Request]]:
    """Yields those that share an event; beside one of every change, a rate is served by queries."""
    periodic = [each for each in requests if each.exchange == "periodic"]
    others = [each for each in requests if each.exchange != "periodic"]
    if not (periodic and others):
        yield requests
        return
    yield others
    yield [replace(each, exchange="query") for each in periodic]
