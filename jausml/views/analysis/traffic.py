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
from jausml.language.semantics.jaus.services import code, with_inherited
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
            bridge_connection
            for bridge_connection in provider.bridgeConnections
            if not (is_to_ros(bridge_connection) or is_single(bridge_connection))
            and code(bridge_connection.map.message) == code(message)
        ]

    def _requested(
        self,
        provider: jaus.Component | None,
        requests: list[Request],
        feeding: list[bridge.Connection],
    ) -> Iterator[Stream]:
        first = requests[0]
        connections: list[Asking] = [*(request.connection for request in requests), *feeding]
        length = max(self._assumptions.length_of(connection) for connection in connections)
        size = self._report_size(first, feeding, length)
        rates = [request.hertz for request in requests if request.exchange != "change"]
        source = feeding[0] if feeding else first.connection
        hertz = max(rates) if rates else self._changes_of(source)
        basis = DECLARED if rates else ASSUMED
        if first.exchange == "query":
            # Each connection asks by itself.
            for request in requests:
                query = self._query_size(request, provider)
                yield self._stream(
                    first.client, provider, query[0], "query", query[1], request.hertz, DECLARED,
                    [request.connection],
                )  # fmt: skip
                yield self._stream(
                    provider, first.client, str(first.message.name), "report", size, request.hertz,
                    DECLARED, [request.connection, *feeding],
                )  # fmt: skip
            return
        hertz = self.offered_rate(provider, hertz) if rates else hertz
        size = size.plus(self._constants.event_header)
        yield self._stream(
            provider,
            first.client,
            str(first.message.name),
            "event",
            size,
            hertz,
            basis,
            connections,
        )
        yield from self._renewals(provider, first, is_periodic=bool(rates))

    def _unrequested(self, owner: bridge.Bridge, connection: bridge.Connection) -> Iterator[Stream]:
        """Yields the streams to one client that is not in the model."""
        size = self._message_size(connection)
        name, exchange = str(connection.map.message.name), connection.exchange.name
        rate = float(connection.rate or owner.frequency)
        if exchange == "everyChangeEvent":
            rate = self._changes_of(connection)
        if exchange == "query":
            request = Request(owner, connection, connection.map.message, "query", rate)
            query = self._query_size(request, owner)
            yield self._stream(
                None, owner, query[0], "query", query[1], rate, ASSUMED, [connection]
            )
            yield self._stream(owner, None, name, "report", size, rate, ASSUMED, [connection])
            return
        size = size.plus(self._constants.event_header)
        yield self._stream(owner, None, name, "event", size, rate, ASSUMED, [connection])

    def offered_rate(self, provider: jaus.Component | None, hertz: float) -> float:
        """Returns the rate that a provider gives a client that asks for another."""
        if provider is None or provider.external:
            return min(hertz, self._constants.highest_event_rate)
        return min(max(hertz, self._constants.event_rate_min), self._constants.highest_event_rate)

    def _report_size(self, request: Request, feeding: list[bridge.Connection], length: int) -> Size:
        present: frozenset[str] | None = None
        if feeding:
            present = frozenset().union(*map(_assigned_fields, feeding))
        if isinstance(request.connection, bridge.Connection) and isinstance(
            request.client, bridge.Bridge
        ):
            query = request.query_of(request.named_provider)
            if query is not None and _has_presence_vector(query):
                asked = requested_fields(request.client).get(request.message, frozenset())
                present = asked if present is None else present & asked
        return jaus_size(wire.resolve(request.message), length, present)

    def _query_size(self, request: Request, provider: jaus.Component | None) -> tuple[str, Size]:
        search = getattr(request.connection, "search", None)
        from_ = provider or search
        query = request.query_of(from_)
        if query is None:
            return "its query", Size(2, 2, 2)
        return str(query.name), jaus_size(wire.resolve(query), self._assumptions.length)

    # ------------------------------------------------------------------ single messages

    def _messages(self) -> Iterator[Stream]:
        sent: list[tuple[bridge.Connection, Stream]] = []
        for owner in self._system.bridges:
            for bridge_connection in owner.bridgeConnections:
                if not is_to_ros(bridge_connection) and is_single(bridge_connection):
                    for peer in peers_of(bridge_connection):
                        sent.append((bridge_connection, self._sent(owner, peer, bridge_connection)))
        for receiver in self._system.bridges:
            for bridge_connection in receiver.bridgeConnections:
                if is_to_ros(bridge_connection) and is_single(bridge_connection):
                    sent += self._received(
                        receiver, bridge_connection, [stream for _, stream in sent]
                    )
        yield from (stream for _, stream in sent)

    def _sent(
        self, owner: bridge.Bridge, peer: jaus.Component | None, connection: bridge.Connection
    ) -> Stream:
        stream = self._stream(
            owner,
            peer,
            str(connection.map.message.name),
            "message",
            self._message_size(connection),
            self._changes_of(connection),
            ASSUMED,
            [connection],
        )
        stream.wants_acknowledgement = bool(connection.acknowledge)
        return stream

    def _received(
        self, receiver: bridge.Bridge, connection: bridge.Connection, sent: list[Stream]
    ) -> list[tuple[bridge.Connection, Stream]]:
        """Adds a connection to the streams that it takes; returns those without a sender."""
        name, known = str(connection.map.message.name), set()
        for stream in sent:
            is_peer = not connection.peers or stream.sender in connection.peers
            if stream.receiver is receiver and stream.message == name and is_peer:
                stream.connections.append(connection)
                known.add(stream.sender)
        missing: list[jaus.Component | None] = [
            peer for peer in connection.peers if peer not in known
        ]
        if not connection.peers and not known:
            missing = [None]
        size = jaus_size(
            wire.resolve(connection.map.message), self._assumptions.length_of(connection)
        )
        rate = self._assumptions.rate_of(connection)
        return [
            (
                connection,
                self._stream(sender, receiver, name, "message", size, rate, ASSUMED, [connection]),
            )
            for sender in missing
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
