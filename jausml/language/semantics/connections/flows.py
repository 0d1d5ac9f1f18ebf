"""Flows of messages from connection to connection of bridges, in which loops are found."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.semantics.connections.topics import resolve_topic, topic_fault
from jausml.language.semantics.jaus.services import code

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge, jaus


@dataclass(frozen=True, slots=True, eq=False)
class Flow:
    """A connection with its bridge.

    Attributes:
        topics: Full names of the topics that are named legally.
    """

    connection: bridge.Connection
    owner: bridge.Bridge
    to_ros: bool
    code: int
    topics: frozenset[str]
    peers: frozenset[jaus.Component]
    is_open: bool

    @property
    def is_message(self) -> bool:
        """Whether messages cross by themselves, neither asked for nor subscribed to."""
        return self.connection.exchange.name == "message"

    def has_peer(self, component: jaus.Component) -> bool:
        """Tells whether messages are exchanged with a component."""
        return component in self.peers or self.is_open


def flow_of(connection: bridge.Connection, owner: bridge.Bridge) -> Flow:
    """Returns a connection as a flow."""
    namespace, node = owner.namespace or "", owner.name or ""
    # What arrives on a joined topic waits for a message on the main one.
    names = [each.name for each in connection.topics if each.name and each.join is None]
    return Flow(
        connection,
        owner,
        to_ros=connection.direction.name == "jausToRos",
        code=code(connection.map.message),
        topics=frozenset(
            resolve_topic(name, namespace, node) for name in names if not topic_fault(name)
        ),
        peers=frozenset(connection.peers),
        # Who is found at run time is not known here.
        is_open=not connection.peers and connection.search is None,
    )


def find_loops(flows: list[Flow]) -> list[list[Flow]]:
    """Returns one loop for each set of connections that reach each other.

    Returns:
        Loops in the order of the connections, each from its first connection on.
    """
    subscribers: dict[str, list[Flow]] = defaultdict(list)
    takers: dict[int, list[Flow]] = defaultdict(list)
    for flow in flows:
        if flow.to_ros:
            takers[flow.code].append(flow)
        for topic in () if flow.to_ros else flow.topics:
            subscribers[topic].append(flow)
    after = {
        flow: [other for topic in sorted(flow.topics) for other in subscribers[topic]]
        if flow.to_ros
        else [other for other in takers[flow.code] if _crosses_jaus(flow, other)]
        for flow in flows
    }
    loops: list[list[Flow]] = []
    reported: set[Flow] = set()
    for flow in flows:
        if flow not in reported:
            loop = _way_back(flow, after)
            if loop:
                loops.append(loop)
                reported.update(loop)
    return loops


def _way_back(start: Flow, after: dict[Flow, list[Flow]]) -> list[Flow]:
    """Returns the shortest way from a connection back to it, empty when there is none."""
    ways: list[list[Flow]] = [[start]]
    seen: set[Flow] = set()
    for way in ways:
        for following in after[way[-1]]:
            if following is start:
                return way
            if following not in seen:
                seen.add(following)
                ways.append([*way, following])
    return []


def _crosses_jaus(sender: Flow, receiver: Flow) -> bool:
    """Tells whether a message that one bridge sends enters ROS again at some bridge."""
    if sender.is_message:
        to_bridge = receiver.owner in sender.peers and receiver.has_peer(sender.owner)
        # Or the message goes to the very peer that sends the same message.
        return to_bridge or not sender.peers.isdisjoint(receiver.peers)
    return sender.owner in receiver.peers and sender.has_peer(receiver.owner)
