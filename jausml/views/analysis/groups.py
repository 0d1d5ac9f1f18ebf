"""Groups: connections of a bridge that no split may part, and why."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics import stops
from jausml.language.semantics.commands import needs_control
from jausml.language.semantics.services import code, lineage
from jausml.language.semantics.shaping import passed_rate
from jausml.language.semantics.topics import resolve_topic
from jausml.views.analysis.cdr import ros_size
from jausml.views.analysis.costs import seconds_of, seconds_of_message
from jausml.views.analysis.streams import is_single, is_to_ros, keeps_control

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator

    from jausml.language.metamodel.classes import jaus
    from jausml.views.analysis.assumptions import Assumptions
    from jausml.views.analysis.streams import Traffic

    Carrier = bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection

_FOUND = "found", "they command who is found at run time, which may be the same component"

_ROS_SERVICES = "ROS services and actions, whose JAUS messages answer each other, stay together"


@dataclass(frozen=True, eq=False)
class Group:
    """Connections that stay in one bridge.

    Attributes:
        longest: Seconds for which one message of theirs keeps the bridge busy at most.
    """

    connections: tuple[Carrier, ...]
    reasons: tuple[str, ...]
    share: float
    longest: float
    has_commands: bool
    is_commanded: bool


def carriers_of(owner: bridge.Bridge) -> list[Carrier]:
    """Returns all connections of a bridge: of topics, of ROS services and of ROS actions."""
    return [*owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections]


def groups_of(owner: bridge.Bridge, traffic: Traffic, assumptions: Assumptions) -> list[Group]:
    """Returns the smallest parts into which a bridge can be split."""
    carriers = carriers_of(owner)
    ties: dict[Hashable, list[Carrier]] = defaultdict(list)
    reasons: dict[Hashable, str] = {}
    for each in carriers:
        for key, reason in _ties(owner, each):
            ties[key].append(each)
            reasons[key] = reason
    leaders = {each: each for each in carriers}
    for tied in ties.values():
        first = _leader(leaders, tied[0])
        for each in tied[1:]:
            leaders[_leader(leaders, each)] = first
    members: dict[Carrier, list[Carrier]] = defaultdict(list)
    for each in carriers:
        members[_leader(leaders, each)].append(each)
    why: dict[Carrier, dict[str, None]] = defaultdict(dict)
    for key, tied in ties.items():
        if len(set(tied)) > 1:
            why[_leader(leaders, tied[0])][reasons[key]] = None
    return [
        _group(inside, tuple(why[leader]), traffic, assumptions)
        for leader, inside in members.items()
    ]


def _leader(leaders: dict[Carrier, Carrier], carrier: Carrier) -> Carrier:
    while leaders[carrier] is not carrier:
        carrier = leaders[carrier]
    return carrier


def _group(
    carriers: list[Carrier], reasons: tuple[str, ...], traffic: Traffic, assumptions: Assumptions
) -> Group:
    share, longest = 0.0, 0.0
    commands: list[Carrier]
    commands = [each for each in carriers if not isinstance(each, bridge.Connection)]
    for each in carriers:
        if not isinstance(each, bridge.Connection):
            continue
        streams = traffic.of(each)
        carried = sum(stream.hertz for stream in streams if stream.kind != "query")
        arriving = carried if is_to_ros(each) else assumptions.rate_of(each)
        size = ros_size(each.map.type, assumptions.length_of(each))
        share += seconds_of(each, streams, size, passed_rate(each, arriving))
        longest = max(longest, seconds_of_message(streams, size))
        if stops.is_command(each):
            commands.append(each)
    is_commanded = any(each.direction.name == "jausToRos" for each in commands)
    return Group(tuple(carriers), reasons, share, longest, bool(commands), is_commanded)


def _ties(owner: bridge.Bridge, carrier: Carrier) -> Iterator[tuple[Hashable, str]]:
    """Yields what a connection may have in common with others, and how to say that."""
    if not isinstance(carrier, bridge.Connection):
        yield "services", _ROS_SERVICES
        # They may ask and command whom topics do, or be asked and commanded as topics are.
        yield from (_controlled(each) for each in carrier.peers)
        if carrier.direction.name == "jausToRos":
            yield from (_provided(each) for each in owner.provides)
            yield _commanded(owner)
        elif carrier.search is not None and carrier.control:
            yield _FOUND
        return
    for each in carrier.topics:
        name = resolve_topic(str(each.name), owner.namespace or "", str(owner.name))
        yield ("topic", name), f"they share the topic {name}"
    message = carrier.map.message
    if is_to_ros(carrier) and not is_single(carrier):
        for peer in carrier.peers:
            text = f"one event of {message.name} from {peer.name} serves them"
            yield ("report", peer, code(message)), text
    for service in owner.provides:
        if serves(service, carrier) or _searches(carrier, service):
            yield _provided(service)
    yield from _control(owner, carrier)


def _control(owner: bridge.Bridge, carrier: bridge.Connection) -> Iterator[tuple[Hashable, str]]:
    """Yields whose control a connection needs, or demands."""
    service = carrier.map.message.eContainer()
    if keeps_control(carrier):
        if carrier.search is not None or _finds_controlled(owner):
            yield _FOUND
        yield from (_controlled(peer) for peer in carrier.peers)
    elif (
        is_to_ros(carrier)
        and is_single(carrier)
        and service is not None
        and needs_control(carrier.map.message, service)
    ):
        yield _commanded(owner)


def _finds_controlled(owner: bridge.Bridge) -> bool:
    return any(
        keeps_control(each)
        if isinstance(each, bridge.Connection)
        else each.control and each.direction.name == "rosToJaus"
        for each in carriers_of(owner)
        if each.search is not None
    )


def _commanded(owner: bridge.Bridge) -> tuple[Hashable, str]:
    return "commanded", f"whoever controls {owner.name} commands all of them"


def _controlled(peer: jaus.Component) -> tuple[Hashable, str]:
    return ("peer", peer), f"one bridge alone can hold control of {peer.name}"


def _provided(service: jaus.Service) -> tuple[Hashable, str]:
    return (
        "service",
        service,
    ), f"one bridge alone provides the service {service.name}"


def serves(service: jaus.Service, carrier: bridge.Connection) -> bool:
    """Tells whether a bridge that provides a service does so by a connection."""
    if is_to_ros(carrier) and not is_single(carrier):
        return False
    wanted = code(carrier.map.message)
    return any(
        code(known) == wanted
        for each in lineage(service)
        for known in (each.inputs if is_to_ros(carrier) else each.outputs)
    )


def _searches(carrier: bridge.Connection, service: jaus.Service) -> bool:
    """Tells whether a search could find the bridge that provides a service, were it another one."""
    urns = {each.urn for each in carrier.search.services} if carrier.search is not None else set()
    return any(each.urn in urns for each in lineage(service))
