"""Report of a system: its connections with load and times, and sums by bridge and by host."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.connections.calls import driver_messages
from jausml.language.semantics.connections.reports import joined_reports, passed_rate
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.subject import remembering
from jausml.views.analysis.budgets import Budget, asked_rate, budgets_of, warnings_of
from jausml.views.analysis.sizes import Assumptions, Size, ros_size
from jausml.views.analysis.streams import Stream, Traffic, Wire, is_to_ros
from jausml.views.analysis.traffic import traffic_of

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.system import System


@dataclass(frozen=True)
class Load:
    """What passes in a second."""

    messages_sent: float
    messages_received: float
    sent: Wire
    received: Wire


@dataclass(frozen=True)
class RosLoad:
    """What passes on the side of ROS."""

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
    """A system."""

    system: str
    assumptions: Assumptions
    hosts: tuple[HostReport, ...]
    components: tuple[ComponentReport, ...]

    @property
    def bridges(self) -> tuple[ComponentReport, ...]:
        """The bridges."""
        return tuple(each for each in self.components if each.is_bridge)


def report_of(system: System, assumptions: Assumptions) -> Report:
    """Returns the report of a system."""
    with remembering():
        return _report_of(system, assumptions)


def _report_of(system: System, assumptions: Assumptions) -> Report:
    traffic = traffic_of(system, assumptions)
    elements = [*system.components, *system.bridges]
    components = tuple(_component(each, system, traffic, assumptions) for each in elements)
    hosts = tuple(
        HostReport(
            str(host.name),
            str(host.transport.name),
            tuple(each.name for each in components if each.host == host.name),
            _load_at({e for e in elements if host_of(system, e) is host}, traffic.streams),
        )
        for host in system.hosts
    )
    return Report(str(system.name), assumptions, hosts, components)


def _component(
    element: jaus.Component, system: System, traffic: Traffic, assumptions: Assumptions
) -> ComponentReport:
    host = host_of(system, element)
    connections = tuple(
        connection_report(each, traffic, assumptions)
        for each in (element.bridgeConnections if isinstance(element, bridge.Bridge) else ())
    )
    asked = (
        f"{each.name}: {text}"
        for each in element.connections
        if each.exchange.name == "periodic" and each.provider is not None
        for text in asked_rate(each.provider, float(each.rate))
    )
    upkeep = [each for each in traffic.streams if each.kind == "upkeep"]
    return ComponentReport(
        str(element.name),
        str(element.address),
        isinstance(element, bridge.Bridge),
        str(host.name) if host is not None else "",
        _load_at({element}, traffic.streams),
        _load_at({element}, upkeep),
        sum(each.share for each in connections),
        tuple(asked),
        connections,
        tuple(calls_of(element)) if isinstance(element, bridge.Bridge) else (),
    )


def connection_report(
    connection: bridge.Connection, traffic: Traffic, assumptions: Assumptions
) -> ConnectionReport:
    """Returns what is told of a connection."""
    streams, owner = traffic.of(connection), connection.eContainer()
    topics = [str(each.name) for each in connection.topics if each.join is None]
    carried = [each for each in streams if each.kind in ("message", "event", "report")]
    out = [each for each in carried if each.sender is owner]
    to_ros = is_to_ros(connection)
    joined = {each.join.message.name for each in joined_reports(connection)}
    joined.discard(connection.map.message.name)
    driving = [each for each in streams if each.message not in joined]
    carried = [each for each in carried if each.message not in joined]
    arriving = sum(each.hertz for each in carried) if to_ros else assumptions.rate_of(connection)
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
            *(str(each.name) for each in connection.topics if each.join is not None),
            *(str(each.join.message.name) for each in joined_reports(connection)),
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
    otherwise = "command" if stops.is_command(connection) else "message"
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
    others = (end for each in streams for end in (each.sender, each.receiver) if end is not owner)
    named = dict.fromkeys(str(each.name) if each is not None else "anybody" for each in others)
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
    """Returns what some components send and receive."""
    counts, out, come = [0.0, 0.0], Wire(), Wire()
    for each in streams:
        if each.sender in elements and each.sender is not None:
            counts[0] += each.hertz
            out, come = out + each.forth, come + each.back
        if each.receiver in elements and each.receiver is not None:
            counts[1] += each.hertz
            out, come = out + each.back, come + each.forth
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
    topics = sum(each.join is None for each in connection.topics)
    packets = sum(
        each.hertz * each.packets * (2 if each.is_acknowledged else 1) for each in streams
    )
    each = MESSAGE + topics * PACKET + ros_size.expected * BYTE
    return arriving * each + packets * PACKET


@dataclass(frozen=True)
class CallReport:
    """A connection with a ROS service or a ROS action; nobody knows its rate and load.

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
    return tuple(str(each.name) for each in messages)


def _peers_of_call(
    connection: bridge.RosServiceConnection | bridge.RosActionConnection,
) -> tuple[str, ...]:
    if connection.search is not None:
        return ("who is found",)
    return tuple(str(each.name) for each in connection.peers)
