"""The bridge that carries all maps of a text, for those who say its address when they run a tool.

The file has maps alone; address and frequency of the bridge are given on the command line.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.names import qualified_name
from jausml.language.model.notation import Known
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.connections.exchanges import EVENT, MESSAGE
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.language.semantics.names import system_name
from jausml.language.text.reading.declared_messages import message_feature
from jausml.language.text.reading.declarer import Declarer
from jausml.language.text.reading.elements import NodeMaker
from jausml.language.text.reading.maps import WrittenEnd
from jausml.language.text.tree import Span


@dataclass(frozen=True, slots=True)
class BridgeOfMaps:
    """The bridge of all maps of a file.

    Attributes:
        frequency: Messages each second of its events, None for the default of bridges.
    """

    path: Path
    address: str
    frequency: float | None = None


DISCOVERY = f"{LIBRARY_URI}jaus/core-1.1.xmi#Discovery"
"""The service of every such bridge, by which components that search its services find it."""

_BRIDGE = "_bridge"
_INPUTS = "inputs"


@dataclass(frozen=True, slots=True)
class _MapWays:
    """A map, the service that has its message, and where the connections go."""

    name: str
    span: Span
    service: str
    is_input: bool
    to_ros: bool
    to_jaus: bool


def add_bridge(
    options: BridgeOfMaps,
    ends: Sequence[WrittenEnd],
    declarer: Declarer,
    known: Known,
    nodes: NodeMaker,
) -> list[Node]:
    """Returns a system with a bridge that carries each map in the directions that it has.

    The bridge provides the services whose messages it reports or takes, and finds components that
    provide those of which it needs the other end.
    """
    maps = list(_maps(ends, declarer, known))
    if not maps:
        return []
    classes, span = nodes.metamodels.classes, maps[0].span
    system = nodes.root(classes["system.System"], span)
    name = system_name(options.path)
    nodes.value(system, "name", name, span)
    bridge = nodes.element(system, "bridges", classes["bridge.Bridge"], span)
    nodes.value(bridge, "name", f"{name.removesuffix(_BRIDGE)}{_BRIDGE}", span)
    nodes.value(bridge, "address", options.address, span)
    if options.frequency is not None:
        nodes.value(bridge, "frequency", f"{options.frequency!r}", span)
    provided = dict.fromkeys(map_ways.service for map_ways in maps if _is_provided(map_ways))
    used = dict.fromkeys(map_ways.service for map_ways in maps if _is_used(map_ways))
    nodes.href(bridge, "provides", DISCOVERY, span)
    for feature, services in (("provides", provided), ("uses", used)):
        for service in services:
            nodes.name(bridge, feature, service, span)
    for map_ways in maps:
        for direction in (TO_ROS, TO_JAUS):
            if map_ways.to_ros if direction == TO_ROS else map_ways.to_jaus:
                _connection(bridge, map_ways, direction, nodes)
    return [system]


def _maps(ends: Sequence[WrittenEnd], declarer: Declarer, known: Known) -> Iterator[_MapWays]:
    """Yields the maps whose service is known; what is wrong with the others is found elsewhere."""
    for written in ends:
        node, end = written.node, written.end
        name = next((child.text for child in node.children if child.tag == "name"), "")
        if not end.is_jaus or not name:
            continue
        directions = {child.tag for child in node.children} & {"toRos", "toJaus"}
        # A map without assignments has its directions from its ends alone: both.
        directions = directions or {"toRos", "toJaus"}
        if (pair := _service_of(written, declarer, known)) is not None:
            service, is_input = pair
            flags = ("toRos" in directions, "toJaus" in directions)
            yield _MapWays(name, end.span, service, is_input, *flags)


def _service_of(written: WrittenEnd, declarer: Declarer, known: Known) -> tuple[str, bool] | None:
    """Returns the service of the message of an end, and whether it takes the message."""
    declaring = declarer.declaration_of(written)
    if declaring is not None:
        return declarer.service.name, message_feature(declaring) == _INPUTS
    messages = known.find("jaus.MessageDef", written.end.type.text)
    if len(messages) != 1:
        return None
    service = qualified_name(messages[0]).rpartition(".")[0]
    return service, messages[0].eContainmentFeature().name == _INPUTS


def _is_provided(map_ways: _MapWays) -> bool:
    return map_ways.to_ros if map_ways.is_input else map_ways.to_jaus


def _is_used(map_ways: _MapWays) -> bool:
    return map_ways.to_jaus if map_ways.is_input else map_ways.to_ros


def _connection(bridge: Node, map_ways: _MapWays, direction: str, nodes: NodeMaker) -> None:
    classes, span = nodes.metamodels.classes, map_ways.span
    # What comes from ROS is told apart from what goes there, or it would come back.
    word = {TO_ROS: "from_jaus", TO_JAUS: "to_jaus"}[direction]
    is_single = not (map_ways.to_ros and map_ways.to_jaus)
    node = nodes.element(bridge, "bridgeConnections", classes["bridge.Connection"], span)
    nodes.value(node, "name", map_ways.name if is_single else f"{map_ways.name}_{word}", span)
    nodes.name(node, "map", map_ways.name, span)
    nodes.value(node, "direction", direction, span)
    nodes.value(node, "exchange", MESSAGE if map_ways.is_input else EVENT, span)
    # The message goes the way of its service from outside, so its peer must be found.
    if map_ways.is_input == (direction == TO_JAUS):
        search = nodes.element(node, "search", classes["jaus.PeerSearch"], span)
        nodes.name(search, "services", map_ways.service, span)
    topic = nodes.element(node, "topics", classes["bridge.Topic"], span)
    nodes.value(topic, "name", map_ways.name if is_single else f"{map_ways.name}/{word}", span)
