"""Report of a system: its connections with load and times, and sums by bridge and by host."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.system import System
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.connections.calls import driver_messages
from jausml.language.semantics.connections.reports import joined_reports, passed_rate
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.subject import remembering
from jausml.views.analysis.budgets import Budget, asked_rate, budgets_of, warnings_of
from jausml.views.analysis.sizes import Assumptions, Size, ros_size
from jausml.views.analysis.streams import Stream, Traffic, Wire
from jausml.views.analysis.traffic import traffic_of


@dataclass(frozen=True)
class Load:
    """The traffic in a second."""

    messages_sent: float
    messages_received: float
    sent: Wire
    received: Wire


@dataclass(frozen=True)
class RosLoad:
    """The traffic on the side of ROS."""

    bytes: Size
    messages_per_s: float


@dataclass(frozen=True)
class Flow:
    """A stream as a connection sees it.

    `kind`: `message`, `event`, `query`, `report` or `upkeep`.
    """

    sender: str
    receiver: str
    message: str
    kind: str
    size: Size
    packets: int
    datagram_bytes: int
    hertz: float
    basis: str
    is_acknowledged: bool


@dataclass(frozen=True)
class ConnectionReport:
    """A connection of a bridge.

    `exchange`: `command`, `message`, `periodic event`, `every-change event` or `query`.
    """

    name: str
    direction: str
    exchange: str
    message: str
    code: str
    type: str
    topics: tuple[str, ...]
    joins: tuple[str, ...]
    peers: tuple[str, ...]
    fan_out: int
    flows: tuple[Flow, ...]
    load: Load
    ros: RosLoad
    share: float
    budgets: tuple[Budget, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class ComponentReport:
    """A component or bridge.

    `host`: name of its host, empty when it has none.
    """

    name: str
    address: str
    is_bridge: bool
    host: str
    load: Load
    upkeep: Load
    share: float
    warnings: tuple[str, ...]
    connections: tuple[ConnectionReport, ...] = ()
    calls: tuple[CallReport, ...] = ()


@dataclass(frozen=True)
class HostReport:
    """A host."""

    name: str
    transport: str
    components: tuple[str, ...]
    load: Load


@dataclass(frozen=True)
class Report:
    """A system.

    `changes`: what it would change if bridges were one, or one were two; each in a sentence.
    """

    system: str
    assumptions: Assumptions
    hosts: tuple[HostReport, ...]
    components: tuple[ComponentReport, ...]
    changes: tuple[str, ...] = ()

    @property
    def bridges(self) -> tuple[ComponentReport, ...]:
        """The bridges."""
        return tuple(component for component in self.components if component.is_bridge)


def report_of(system: System, assumptions: Assumptions) -> Report:
    """Returns the report of a system."""
    with remembering():
        return _report_of(system, assumptions)


def _report_of(system: System, assumptions: Assumptions) -> Report:
    traffic = traffic_of(system, assumptions)
    elements = [*system.components, *system.bridges]
    components = tuple(_component(element, system, traffic, assumptions) for element in elements)
    hosts = tuple(
        HostReport(
            str(host.name),
            str(host.transport.name),
            tuple(component.name for component in components if component.host == host.name),
            _load_at(
                {element for element in elements if host_of(system, element) is host},
                traffic.streams,
            ),
        )
        for host in system.hosts
    )
    return Report(str(system.name), assumptions, hosts, components)


def _component(
    element: jaus.Component, system: System, traffic: Traffic, assumptions: Assumptions
) -> ComponentReport:
    host = host_of(system, element)
    connections = tuple(
        connection_report(bridge_connection, traffic, assumptions)
        for bridge_connection in (
            element.bridgeConnections if isinstance(element, bridge.Bridge) else ()
        )
    )
    asked = (
        f"{connection.name}: {text}"
        for connection in element.connections
        if connection.exchange.name == "periodic" and connection.provider is not None
        for text in asked_rate(connection.provider, float(connection.rate))
    )
    upkeep = [stream for stream in traffic.streams if stream.kind == "upkeep"]
    return ComponentReport(
        str(element.name),
        str(element.address),
        isinstance(element, bridge.Bridge),
        str(host.name) if host is not None else "",
        _load_at({element}, traffic.streams),
        _load_at({element}, upkeep),
        sum(connection.share for connection in connections),
        tuple(asked),
        connections,
        tuple(calls_of(element)) if isinstance(element, bridge.Bridge) else (),
    )


def connection_report(
    connection: bridge.Connection, traffic: Traffic, assumptions: Assumptions
) -> ConnectionReport:
    """Returns the report on a connection."""
    streams, owner = traffic.of(connection), connection.eContainer()
    topics = [str(topic.name) for topic in connection.topics if topic.join is None]
    carried = [stream for stream in streams if stream.kind in ("message", "event", "report")]
    out = [stream for stream in carried if stream.sender is owner]
    to_ros = is_to_ros(connection)
    joined = {joined_report.join.message.name for joined_report in joined_reports(connection)}
    joined.discard(connection.map.message.name)
    driving = [stream for stream in streams if stream.message not in joined]
    carried = [stream for stream in carried if stream.message not in joined]
    arriving = (
        sum(stream.hertz for stream in carried) if to_ros else assumptions.rate_of(connection)
    )
    passing = passed_rate(connection, arriving)
    size = ros_size(connection.map.type, assumptions.length_of(connection))
    return ConnectionReport(
        name=str(connection.name),
        direction=str(connection.direction.name),
        exchange=_exchange(connection),
        message=str(connection.map.message.name),
        code=f"{code(connection.map.message):04X}",
        type=_type_name(connection),
        topics=tuple(topics),
        joins=(
            *(str(topic.name) for topic in connection.topics if topic.join is not None),
            *(str(joined_report.join.message.name) for joined_report in joined_reports(connection)),
        ),
        peers=_peers(connection, streams, owner),
        fan_out=len(topics) if to_ros else len(out),
        flows=tuple(map(_flow, streams)),
        load=_load_at({owner}, streams),
        ros=RosLoad(size, (passing if to_ros else arriving) * len(topics)),
        share=seconds_of(connection, streams, size, passing),
        budgets=budgets_of(connection, driving, assumptions.rate_of(connection)),
        warnings=tuple(warnings_of(connection, streams, assumptions.rate_of(connection))),
    )


def _exchange(connection: bridge.Connection) -> str:
    words = {
        "periodicEvent": "periodic event",
        "everyChangeEvent": "every-change event",
        "query": "query",
    }
    otherwise = "command" if stops.carries_commands(connection) else "message"
    return words.get(connection.exchange.name, otherwise)


def _type_name(connection: bridge.Connection) -> str:
    kind = connection.map.type
    package = kind.eContainer()
    return f"{package.name}/{kind.name}" if package is not None else str(kind.name)


def _peers(
    connection: bridge.Connection, streams: list[Stream], owner: bridge.Bridge | None
) -> tuple[str, ...]:
    if connection.search is not None:
        return ("found by service",)
    others = (
        end for stream in streams for end in (stream.sender, stream.receiver) if end is not owner
    )
    named = dict.fromkeys(str(other.name) if other is not None else "anybody" for other in others)
    return tuple(named)


def _flow(stream: Stream) -> Flow:
    whole = stream.forth.times(1 / stream.hertz)
    return Flow(
        _name(stream.sender),
        _name(stream.receiver),
        stream.message,
        stream.kind,
        stream.size,
        stream.packets,
        round(whole.judp),
        stream.hertz,
        stream.basis,
        stream.is_acknowledged,
    )


def _name(component: jaus.Component | None) -> str:
    return str(component.name) if component is not None else "anybody"


def _load_at(elements: set[jaus.Component | None], streams: Iterable[Stream]) -> Load:
    """Returns the load of some components: sent and received."""
    counts, out, come = [0.0, 0.0], Wire(), Wire()
    for stream in streams:
        if stream.sender in elements and stream.sender is not None:
            counts[0] += stream.hertz
            out, come = out + stream.forth, come + stream.back
        if stream.receiver in elements and stream.receiver is not None:
            counts[1] += stream.hertz
            out, come = out + stream.back, come + stream.forth
    return Load(counts[0], counts[1], out, come)


# What messages cost a processor (docs/adr/0023-costs-of-a-bridge.md), rounded up from what
# `make bench` writes: the figures tell bridges apart, and promise nothing about a computer.
MESSAGE = 65e-6
"""Seconds for a message to come in, be translated and go out: a bridge carries 15,000 a second."""

PACKET = 15e-6
"""Seconds for each further packet, acknowledgement or topic: a grid of 40 kB has ten."""

BYTE = 1.5e-9
"""Seconds for each byte of a ROS message besides: 60 kB take a tenth of a millisecond."""


def seconds_of(
    connection: bridge.Connection, streams: list[Stream], ros_size: Size, arriving: float
) -> float:
    """Returns the processor time of a connection in each second: the share of one processor."""
    topics = sum(topic.join is None for topic in connection.topics)
    packets = sum(
        stream.hertz * stream.packets * (2 if stream.is_acknowledged else 1) for stream in streams
    )
    seconds = MESSAGE + topics * PACKET + ros_size.expected * BYTE
    return arriving * seconds + packets * PACKET


def seconds_of_message(
    connection: bridge.Connection, streams: list[Stream], ros_size: Size
) -> float:
    """Returns the time for which one message of a connection keeps its bridge busy."""
    topics = sum(topic.join is None for topic in connection.topics)
    packets = max((stream.packets for stream in streams), default=1)
    return MESSAGE + (topics + packets) * PACKET + ros_size.expected * BYTE


@dataclass(frozen=True)
class CallReport:
    """A connection with a ROS service or a ROS action, of unknown rate and load.

    `kind`: `service` or `action`. `messages`: names of the JAUS messages that are exchanged; for an
    action those of the list driver, and what an element of a list holds.
    """

    name: str
    direction: str
    kind: str
    ros_name: str
    type: str
    messages: tuple[str, ...]
    peers: tuple[str, ...]
    seconds: float


def calls_of(owner: bridge.Bridge) -> Iterator[CallReport]:
    """Yields the connections of a bridge with services, then those with actions."""
    for service in owner.serviceConnections:
        yield CallReport(
            str(service.name),
            str(service.direction.name),
            "service",
            str(service.service),
            str(service.type.name),
            _names(calls.messages(service)),
            _peers_of_call(service),
            float(service.timeout),
        )
    for action in owner.actionConnections:
        driver = driver_messages(action.driver)
        known = driver.all if driver is not None else ()
        yield CallReport(
            str(action.name),
            str(action.direction.name),
            "action",
            str(action.action),
            str(action.type.name),
            _names((action.element.message, *known)),
            _peers_of_call(action),
            float(action.timeout),
        )


def _names(messages: Iterable[jaus.MessageDef]) -> tuple[str, ...]:
    return tuple(str(message.name) for message in messages)


def _peers_of_call(
    connection: bridge.RosServiceConnection | bridge.RosActionConnection,
) -> tuple[str, ...]:
    if connection.search is not None:
        return ("who is found",)
    return tuple(str(peer.name) for peer in connection.peers)
