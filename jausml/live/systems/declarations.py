"""Declarations of a model for a running system: its connections, and names of its components."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import Model
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.language.semantics.directions import is_to_ros
from jausml.live.recording.ros_definitions import full_name
from jausml.live.systems.state import DeclaredConnection, TopicName


def declarations_of(model: Model) -> Iterator[DeclaredConnection]:
    """Yields the connections of a model, in model order."""
    for owner in model.instances(bridge.Bridge, library=False):
        topics: dict[object, list[TopicName]] = {}
        for end in endpoints([owner]):
            topic_names = topics.setdefault(end.element.eContainer(), [])
            is_absolute = end.topic == getattr(end.element, end.feature)
            topic_names.append(TopicName(end.topic, full_name(end.type), is_absolute))
        for connection in owner.bridgeConnections:
            if connection.map is not None and connection.map.message is not None:
                yield _with_topics(owner, connection, tuple(topics.get(connection, ())))
        for service in owner.serviceConnections:
            asking = calls.asking(service)
            yield _declared(owner, service, str(asking.name) if asking is not None else "")
        for action in owner.actionConnections:
            if action.element is not None and action.element.message is not None:
                yield _declared(owner, action, str(action.element.message.name))


def components_of(model: Model) -> dict[str, str]:
    """Returns the names of the components of a model, bridges included, by JAUS id."""
    components = model.instances(jaus.Component, library=False)
    return {
        str(component.address): str(component.name) for component in components if component.address
    }


def _declared(
    owner: bridge.Bridge,
    connection: bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection,
    message: str,
) -> DeclaredConnection:
    """Returns the declaration of a connection of any kind, without topics and rate."""
    return DeclaredConnection(
        bridge=node_of(owner),
        name=str(connection.name),
        jaus_id=str(owner.address),
        rate=None,
        direction="to ROS" if is_to_ros(connection) else "to JAUS",
        topics=(),
        message=message,
        is_report=False,
        peers=tuple(str(peer.address) for peer in connection.peers),
    )


def _with_topics(
    owner: bridge.Bridge, connection: bridge.Connection, topics: tuple[TopicName, ...]
) -> DeclaredConnection:
    declared = _declared(owner, connection, str(connection.map.message.name))
    exchange = connection.exchange.name
    is_periodic = exchange in ("periodicEvent", "query") and declared.direction == "to ROS"
    rate = (connection.rate or owner.frequency or None) if is_periodic else None
    return replace(declared, rate=rate, topics=topics, is_report=exchange != "message")


def node_of(owner: bridge.Bridge) -> str:
    """Returns the full name of the ROS node of a bridge."""
    return resolve_topic(str(owner.name), owner.namespace or "", "")
