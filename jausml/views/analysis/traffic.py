"""Traffic: the streams of a system.

Each stream is made once, at the end that decides about it: reports at the client that asks for
them, single messages at their sender. Connections at the other end share it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from jausml.language import wire
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.system import System
from jausml.language.semantics.connections.reports import passed_rate, requested_fields
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.jaus.core_services import standard_services
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.paths.scopes import parse_path, spelled_out, target_paths
from jausml.views.analysis.sizes import Assumptions, Size, jaus_size, runtime_constants
from jausml.views.analysis.streams import (
    ASSUMED,
    DECLARED,
    Asking,
    Request,
    Stream,
    Traffic,
    alike_requests,
    is_single,
    keeps_control,
    peers_of,
    requests_of,
)

_PRESENCE_VECTOR = "PresenceVector"


def traffic_of(system: System, assumptions: Assumptions) -> Traffic:
    """Returns the streams of a system."""
    streams = _Streams(system, assumptions).all()
    by_connection: dict[Asking, list[Stream]] = defaultdict(list)
    for stream in streams:
        for connection in stream.connections:
            by_connection[connection].append(stream)
    return Traffic(tuple(streams), dict(by_connection))


class _Streams:
    """Makes the streams of a system."""

    def __init__(self, system: System, assumptions: Assumptions) -> None:
        self._system = system
        self._assumptions = assumptions
        self._constants = runtime_constants()
        self._components: list[jaus.Component] = [*system.components, *system.bridges]
        self._core = {
            str(output.name): wire.resolve(output)
            for service in with_inherited(standard_services())
            for output in (*service.inputs, *service.outputs)
        }

    def all(self) -> list[Stream]:
        """Returns the streams, those of a connection at the other end shared with it."""
        return [*self._reports(), *self._messages(), *self._upkeep()]

    # ------------------------------------------------------------------ reports

    def _reports(self) -> Iterator[Stream]:
        groups: dict[tuple[object, object, int, bool], list[Request]] = defaultdict(list)
        for provider, request in requests_of(self._system):
            is_query = request.exchange == "query"
            key = provider or request.connection, request.client, code(request.message), is_query
            groups[key].append(request)
        served = set()
        for (origin, *_), requests in groups.items():
            provider = origin if isinstance(origin, jaus.Component) else None
            feeding = self._feeding(provider, requests[0].message)
            served.update(feeding)
            for alike in alike_requests(requests):
                yield from self._requested(provider, alike, feeding)
        for owner in self._system.bridges:
            for connection in owner.bridgeConnections:
                if not (is_to_ros(connection) or is_single(connection) or connection in served):
                    yield from self._unrequested(owner, connection)

    def _feeding(
        self, provider: jaus.Component | None, message: jaus.MessageDef
    ) -> list[bridge.Connection]:
        """Returns the connections of a bridge that make a report."""
        if not isinstance(provider, bridge.Bridge):
            return []
        return [
            connection
            for connection in provider.bridgeConnections
            if not (is_to_ros(connection) or is_single(connection))
            and code(connection.map.message) == code(message)
        ]

    def _requested(
        self,
        provider: jaus.Component | None,
        requests: list[Request],
        feeding: list[bridge.Connection],
    ) -> Iterator[Stream]:
        """Yields the streams of requests that share an event, or of queries for one message.

        Args:
            feeding: The connections of the provider that make the report.
        """
        first = requests[0]
        connections: list[Asking] = [*(request.connection for request in requests), *feeding]
        length = max(self._assumptions.length_of(connection) for connection in connections)
        size = self._report_size(first, feeding, length)
        if first.exchange == "query":
            for request in requests:
                yield from self._queried(first.client, provider, request, feeding, size, DECLARED)
            return
        rates = [request.hertz for request in requests if request.exchange != "change"]
        if rates:
            hertz, basis = self._offered_rate(provider, max(rates)), DECLARED
        else:
            hertz, basis = self._changes_of(feeding[0] if feeding else first.connection), ASSUMED
        name, size = str(first.message.name), size.plus(self._constants.event_header)
        yield self._stream(provider, first.client, name, "event", size, hertz, basis, connections)
        yield from self._renewals(provider, first, is_periodic=bool(rates))

    def _queried(
        self,
        client: jaus.Component | None,
        provider: jaus.Component | None,
        request: Request,
        feeding: list[bridge.Connection],
        size: Size,
        basis: str,
    ) -> Iterator[Stream]:
        """Yields a query of a connection, and the report of a size that answers it."""
        asking, hertz = request.connection, request.hertz
        query, query_size = self._query_size(request, provider)
        yield self._stream(client, provider, query, "query", query_size, hertz, basis, [asking])
        name, ends = str(request.message.name), [asking, *feeding]
        yield self._stream(provider, client, name, "report", size, hertz, basis, ends)

    def _unrequested(self, owner: bridge.Bridge, connection: bridge.Connection) -> Iterator[Stream]:
        """Yields the streams to one client that is not in the model."""
        size = self._message_size(connection)
        exchange = connection.exchange.name
        rate = float(connection.rate or owner.frequency)
        if exchange == "everyChangeEvent":
            rate = self._changes_of(connection)
        if exchange == "query":
            request = Request(owner, connection, connection.map.message, "query", rate)
            yield from self._queried(None, owner, request, [], size, ASSUMED)
            return
        name, size = str(connection.map.message.name), size.plus(self._constants.event_header)
        yield self._stream(owner, None, name, "event", size, rate, ASSUMED, [connection])

    def _offered_rate(self, provider: jaus.Component | None, hertz: float) -> float:
        """Returns the rate that a provider gives a client that asks for another."""
        if provider is None or provider.external:
            return min(hertz, self._constants.highest_event_rate)
        return min(max(hertz, self._constants.event_rate_min), self._constants.highest_event_rate)

    def _report_size(self, request: Request, feeding: list[bridge.Connection], length: int) -> Size:
        """Returns the size of a report with the fields that its provider fills and is asked for."""
        present = frozenset().union(*map(_assigned_fields, feeding)) if feeding else None
        if isinstance(request.client, bridge.Bridge) and isinstance(
            request.connection, bridge.Connection
        ):
            query = request.query_of(request.named_provider)
            if query is not None and _has_presence_vector(query):
                asked = requested_fields(request.client).get(request.message, frozenset())
                present = asked if present is None else present & asked
        return jaus_size(wire.resolve(request.message), length, present)

    def _query_size(self, request: Request, provider: jaus.Component | None) -> tuple[str, Size]:
        """Returns the name of the query for a report, and its size."""
        query = request.query_of(provider or getattr(request.connection, "search", None))
        if query is None:
            return "its query", Size(2, 2, 2)
        return str(query.name), jaus_size(wire.resolve(query), self._assumptions.length)

    # ------------------------------------------------------------------ single messages

    def _messages(self) -> list[Stream]:
        streams = [
            self._sent(owner, peer, connection)
            for owner in self._system.bridges
            for connection in owner.bridgeConnections
            if is_single(connection) and not is_to_ros(connection)
            for peer in peers_of(connection)
        ]
        for receiver in self._system.bridges:
            for connection in receiver.bridgeConnections:
                if is_single(connection) and is_to_ros(connection):
                    streams += self._received(receiver, connection, streams)
        return streams

    def _sent(
        self, owner: bridge.Bridge, peer: jaus.Component | None, connection: bridge.Connection
    ) -> Stream:
        name, size = str(connection.map.message.name), self._message_size(connection)
        rate = self._changes_of(connection)
        stream = self._stream(owner, peer, name, "message", size, rate, ASSUMED, [connection])
        stream.wants_acknowledgement = bool(connection.acknowledge)
        return stream

    def _received(
        self, receiver: bridge.Bridge, connection: bridge.Connection, sent: list[Stream]
    ) -> list[Stream]:
        """Adds a connection to the streams that it takes; returns those without a sender."""
        name, senders = str(connection.map.message.name), set()
        for stream in sent:
            is_peer = not connection.peers or stream.sender in connection.peers
            if stream.receiver is receiver and stream.message == name and is_peer:
                stream.connections.append(connection)
                senders.add(stream.sender)
        if senders and not connection.peers:
            return []
        length = self._assumptions.length_of(connection)
        size = jaus_size(wire.resolve(connection.map.message), length)
        rate = self._assumptions.rate_of(connection)
        return [
            self._stream(peer, receiver, name, "message", size, rate, ASSUMED, [connection])
            for peer in peers_of(connection)
            if peer not in senders
        ]

    def _changes_of(self, source: Asking) -> float:
        """Returns the rate at which a source makes its connection send."""
        rate = self._assumptions.rate_of(source)
        if not isinstance(source, bridge.Connection) or is_to_ros(source):
            return rate
        return passed_rate(source, rate)

    def _message_size(self, connection: bridge.Connection) -> Size:
        layout = wire.resolve(connection.map.message)
        length = self._assumptions.length_of(connection)
        return jaus_size(layout, length, _assigned_fields(connection))

    # ------------------------------------------------------------------ upkeep

    def _renewals(
        self, provider: jaus.Component | None, request: Request, *, is_periodic: bool
    ) -> Iterator[Stream]:
        """Yields the renewals of an event (AS5710, Events)."""
        minutes = int(provider.eventTimeout) if provider is not None else 1
        waits = [30.0 * minutes] if minutes else []
        if not is_periodic:
            waits.append(self._constants.check_interval)
        if not waits:
            return
        query = self._query_size(request, provider)[1].expected
        hertz = 1 / min(waits)
        yield self._core_stream(
            request.client, provider, "UpdateEvent", hertz, query, wants_acknowledgement=True
        )
        yield self._core_stream(provider, request.client, "ConfirmEventRequest", hertz)

    def _upkeep(self) -> Iterator[Stream]:
        """Yields the streams that keep control of others (AS5710, AccessControl)."""
        for owner in self._components:
            for target in dict.fromkeys(_controlled(owner)):
                longest = self._constants.watch_interval
                timeout = int(target.controlTimeout)
                interval = min(longest, timeout / self._constants.renewals) if timeout else longest
                hertz = 1 / interval
                yield self._core_stream(
                    owner, target, "RequestControl", hertz, wants_acknowledgement=True
                )
                yield self._core_stream(target, owner, "ConfirmControl", hertz)
                yield self._core_stream(owner, target, "QueryStatus", hertz)
                yield self._core_stream(target, owner, "ReportStatus", hertz)

    def _core_stream(
        self,
        sender: jaus.Component | None,
        receiver: jaus.Component | None,
        name: str,
        hertz: float,
        length: int = 0,
        *,
        wants_acknowledgement: bool = False,
    ) -> Stream:
        size = jaus_size(self._core[name], length)
        stream = self._stream(sender, receiver, name, "upkeep", size, hertz, DECLARED, [])
        stream.wants_acknowledgement = wants_acknowledgement
        return stream

    def _stream(
        self,
        sender: jaus.Component | None,
        receiver: jaus.Component | None,
        message: str,
        kind: str,
        size: Size,
        hertz: float,
        basis: str,
        connections: list[Asking],
    ) -> Stream:
        host = host_of(self._system, sender) if sender is not None else None
        fragment = int(host.fragmentSize) if host else self._constants.largest_fragment
        return Stream(
            sender, receiver, message, kind, size, hertz, basis, fragment, connections=connections
        )


def _controlled(owner: jaus.Component) -> Iterator[jaus.Component]:
    """Yields the components whose control a component keeps."""
    yield from owner.controls
    for connection in owner.bridgeConnections if isinstance(owner, bridge.Bridge) else ():
        if keeps_control(connection):
            yield from connection.peers


def _assigned_fields(connection: bridge.Connection) -> frozenset[str]:
    """Returns the fields of a JAUS message that a map may fill."""
    paths = [
        parse_path(path)
        for assignment in spelled_out(connection.map, to_ros=False)
        if not isinstance(assignment, bridge.Ignore)
        for path in target_paths(assignment)
    ]
    return frozenset(path[0] for path in paths if path)


def _has_presence_vector(query: jaus.MessageDef) -> bool:
    return any(member.name == _PRESENCE_VECTOR for member in wire.resolve(query).members)
