"""Streams: messages of one kind from one component to another, and requests for them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass, field, replace
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.system import System
from jausml.language.semantics.connections.reports import JoinedReport, joined_reports
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import obeys_controller_alone
from jausml.language.semantics.jaus.services import Provider, find_query
from jausml.views.analysis.sizes import Size, runtime_constants

Asking: TypeAlias = "bridge.Connection | jaus.ServiceConnection"

DECLARED, ASSUMED = "declared", "assumed"
"""Where a rate is from: the model, or an assumption."""


@dataclass(eq=False)
class Stream:
    """Messages of one kind from one component to another.

    Attributes:
        sender: Who sends; None for whoever it is.
        receiver: Who receives; None for whoever it is.
        kind: `message`, `event`, `query`, `report` or `upkeep`.
        size: Bytes of the message with its code, that of an event with its header.
    """

    sender: jaus.Component | None
    receiver: jaus.Component | None
    message: str
    kind: str
    size: Size
    hertz: float
    basis: str
    fragment_size: int
    wants_acknowledgement: bool = False
    connections: list[Asking] = field(default_factory=list)

    @property
    def packets(self) -> int:
        """Packets of an expected message."""
        return packet_count(self.size.expected, self.fragment_size)

    @property
    def is_acknowledged(self) -> bool:
        """Whether its packets are acknowledged, as those of a message of many are in any case."""
        return self.wants_acknowledgement or self.packets > runtime_constants().at_once

    @property
    def forth(self) -> Wire:
        """The packets and bytes on the network each second."""
        return on_wire(self.size.expected, self.fragment_size).times(self.hertz)

    @property
    def back(self) -> Wire:
        """The packets and bytes of its acknowledgements on the network each second."""
        return acknowledgements(self.packets * self.hertz if self.is_acknowledged else 0)


@dataclass(frozen=True)
class Traffic:
    """All streams of a system."""

    streams: tuple[Stream, ...]
    by_connection: dict[Asking, list[Stream]]

    def of(self, connection: Asking) -> list[Stream]:
        """Returns the streams of a connection."""
        return self.by_connection.get(connection, [])


def is_single(connection: bridge.Connection) -> bool:
    """Tells whether a connection takes or sends each message by itself."""
    return bool(connection.exchange.name == "message")


def keeps_control(connection: bridge.Connection) -> bool:
    """Tells whether a bridge keeps control of its peers for a connection."""
    if is_to_ros(connection) or not is_single(connection) or not connection.control:
        return False
    service = connection.map.message.eContainer()
    return service is not None and obeys_controller_alone(connection.map.message, service)


VERSION_BYTE = 1
"""Byte before the packet of a datagram (AS5669A, JUDP)."""

UDP_HEADER = 8
IP_HEADER = 20
"""Bytes of an IPv4 header without options; each fragment of a datagram has one."""

ETHERNET_PAYLOAD = 1500
"""Most bytes of an IP packet in an Ethernet frame; larger datagrams are cut by IP."""

ETHERNET_OVERHEAD = 38
"""Bytes of a frame besides its payload: preamble 8, header 14, check sum 4, gap 12."""

_SHORTEST_PAYLOAD = 46
_FRAGMENT_STEP = 8  # offsets of IP fragments are counted in eight bytes


@dataclass(frozen=True)
class Wire:
    """Bytes of messages, one layer around the other."""

    packets: float = 0
    judp: float = 0
    ip: float = 0
    ethernet: float = 0

    def __add__(self, other: Wire) -> Wire:
        """Returns the sum of two."""
        return Wire(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))

    def times(self, factor: float) -> Wire:
        """Returns as much of it."""
        return Wire(*(amount * factor for amount in astuple(self)))


def packet_count(payload: int, fragment_size: int) -> int:
    """Returns how many packets a message takes."""
    return 1 if payload <= fragment_size else -(-payload // _step(payload, fragment_size))


def on_wire(payload: int, fragment_size: int) -> Wire:
    """Returns the packets and bytes of a message to one component on the network."""
    count, step = packet_count(payload, fragment_size), _step(payload, fragment_size)
    return _datagram(step).times(count - 1) + _datagram(payload - (count - 1) * step)


def acknowledgements(packets: float) -> Wire:
    """Returns the packets and bytes of the acknowledgements of packets."""
    return _datagram(0).times(packets)


def _step(payload: int, fragment_size: int) -> int:
    """Returns the payload of one packet by the rule of the runtime."""
    constants = runtime_constants()
    if payload <= fragment_size:
        return fragment_size
    needed = -(-payload // constants.most_small_fragments)
    return max(fragment_size, min(constants.largest_fragment, needed))


def _datagram(payload: int) -> Wire:
    judp = VERSION_BYTE + runtime_constants().empty_message + payload
    whole = judp + UDP_HEADER
    room = (ETHERNET_PAYLOAD - IP_HEADER) // _FRAGMENT_STEP * _FRAGMENT_STEP
    frames = -(-whole // room)
    ip = whole + frames * IP_HEADER
    padding = max(0, _SHORTEST_PAYLOAD - (whole - (frames - 1) * room + IP_HEADER))
    return Wire(1, judp, ip, ip + frames * ETHERNET_OVERHEAD + padding)


_KINDS = {"everyChangeEvent": "change", "query": "query", "periodicEvent": "periodic"}


@dataclass(frozen=True)
class Request:
    """The request of a client to a provider.

    `exchange`: `periodic`, `change` or `query`. `joined`: the join that the report is for; None for
    what the connection is for.
    """

    client: jaus.Component
    connection: Asking
    message: jaus.MessageDef
    exchange: str
    hertz: float
    joined: JoinedReport | None = None

    @property
    def named_provider(self) -> Provider | None:
        """The provider that is asked first; None when the model names none."""
        if self.joined is not None:
            return next(iter(self.joined.peers), None)
        if isinstance(self.connection, bridge.Connection):
            return next(iter(self.connection.peers), self.connection.search)
        return None

    def query_of(self, provider: Provider | None) -> jaus.MessageDef | None:
        """Returns the query for a provider; None when it is not known."""
        if provider is None:
            return None
        if self.joined is not None:
            return self.joined.query_of(provider)
        return find_query(self.connection, provider)


def requests_of(system: System) -> Iterator[tuple[jaus.Component | None, Request]]:
    """Yields whom clients ask for reports, and what for; None is a peer without a name."""
    for owner in system.bridges:
        for bridge_connection in owner.bridgeConnections:
            if is_to_ros(bridge_connection) and not is_single(bridge_connection):
                kind = _KINDS[bridge_connection.exchange.name]
                rate = 0.0 if kind == "change" else float(bridge_connection.rate or owner.frequency)
                for peer in peers_of(bridge_connection):
                    yield (
                        peer,
                        Request(
                            owner, bridge_connection, bridge_connection.map.message, kind, rate
                        ),
                    )
            yield from _joined_requests(owner, bridge_connection)
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
                peer for peer in report.peers if isinstance(peer, jaus.Component)
            ]
            yield from ((peer, request) for peer in named or [None])


def peers_of(connection: bridge.Connection) -> list[jaus.Component | None]:
    """Returns the components at the other end; None stands for those that nobody names."""
    return [*connection.peers] or [None]


def alike_requests(requests: list[Request]) -> Iterator[list[Request]]:
    """Yields requests that share an event; beside one of every change, queries serve a rate."""
    periodic = [request for request in requests if request.exchange == "periodic"]
    others = [request for request in requests if request.exchange != "periodic"]
    if not (periodic and others):
        yield requests
        return
    yield others
    yield [replace(request, exchange="query") for request in periodic]
