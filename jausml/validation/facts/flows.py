"""How messages flow from connection to connection of bridges, to find loops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from jausml.validation.facts.services import same_code
from jausml.validation.facts.topics import resolve_topic, topic_fault


@dataclass(frozen=True, slots=True)
class Flow:
    """A connection with its bridge.

    Attributes:
        connection: The `bridge.Connection`.
        owner: The bridge that has it.
    """

    connection: Any
    owner: Any

    @property
    def to_ros(self) -> bool:
        """Whether it publishes."""
        return bool(self.connection.direction.name == "jausToRos")

    @property
    def topics(self) -> frozenset[str]:
        """Full names of the topics that are named legally."""
        namespace, node = self.owner.namespace or "", self.owner.name or ""
        names = [each.name for each in self.connection.topics if each.name]
        return frozenset(
            resolve_topic(name, namespace, node) for name in names if not topic_fault(name)
        )

    @property
    def is_message(self) -> bool:
        """Whether messages cross by themselves, neither asked for nor subscribed to."""
        return bool(self.connection.exchange.name == "message")

    def has_peer(self, component: Any) -> bool:
        """Tells whether messages are exchanged with a component; no peers means any."""
        peers = self.connection.peers
        return component in peers or not peers


def find_loops(flows: list[Flow]) -> list[list[Flow]]:
    """Returns one loop for each set of connections that reach each other.

    Args:
        flows: The connections of a system.

    Returns:
        Loops in the order of the connections, each from its first connection on.
    """
    after = {flow: [other for other in flows if _feeds(flow, other)] for flow in flows}
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
            if following == start:
                return way
            if following not in seen:
                seen.add(following)
                ways.append([*way, following])
    return []


def _feeds(first: Flow, second: Flow) -> bool:
    """Tells whether what one connection delivers is taken up by another."""
    if first.to_ros:
        return not second.to_ros and not first.topics.isdisjoint(second.topics)
    return second.to_ros and _crosses_jaus(first, second)


def _crosses_jaus(sender: Flow, receiver: Flow) -> bool:
    """Tells whether a message that one bridge sends enters ROS again at some bridge."""
    if not same_code(sender.connection.map.message, receiver.connection.map.message):
        return False
    if sender.is_message:
        to_bridge = receiver.owner in sender.connection.peers and receiver.has_peer(sender.owner)
        return to_bridge or _is_echo(sender, receiver)
    return sender.owner in receiver.connection.peers and sender.has_peer(receiver.owner)


def _is_echo(sender: Flow, receiver: Flow) -> bool:
    """Tells whether a message goes to the very peer that sends the same message."""
    return any(peer in receiver.connection.peers for peer in sender.connection.peers)
