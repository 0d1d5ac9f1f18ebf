"""What a model promises of a running system: its connections and its components."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.language.semantics.ros_types import package_of
from jausml.live.systems.state import DeclaredConnection, TopicName

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.model import Model


def declarations_of(model: Model) -> Iterator[DeclaredConnection]:
    """Yields the connections of a model, in model order."""
    for owner in model.instances(bridge.Bridge, library=False):
        topics: dict[object, list[TopicName]] = {}
        for end in endpoints([owner]):
            found = topics.setdefault(end.element.eContainer(), [])
            is_absolute = end.topic == getattr(end.element, end.feature)
            found.append(TopicName(end.topic, _full_name(end.type), is_absolute))
        for connection in owner.bridgeConnections:
            if connection.map is not None and connection.map.message is not None:
                yield _declaration(owner, connection, tuple(topics.get(connection, ())))
        for service in owner.serviceConnections:
            asking = calls.asking(service)
            yield _called(owner, service, str(asking.name) if asking is not None else "")
        for action in owner.actionConnections:
            if action.element is not None and action.element.message is not None:
                yield _called(owner, action, str(action.element.message.name))


def components_of(model: Model) -> dict[str, str]:
    """Returns the names of the components of a model, bridges included, by JAUS id."""
    components = model.instances(jaus.Component, library=False)
    return {str(each.address): str(each.name) for each in components if each.address}


def _declaration(
    owner: bridge.Bridge, connection: bridge.Connection, topics: tuple[TopicName, ...]
) -> DeclaredConnection:
    exchange, to_ros = connection.exchange.name, connection.direction.name == "jausToRos"
    is_periodic = exchange in ("periodicEvent", "query") and to_ros
    return DeclaredConnection(
        bridge=node_of(owner),
        name=str(connection.name),
        jaus_id=str(owner.address),
        rate=(connection.rate or owner.frequency or None) if is_periodic else None,
        direction="to ROS" if to_ros else "to JAUS",
        topics=topics,
        message=str(connection.map.message.name),
        is_report=exchange != "message",
        peers=tuple(str(each.address) for each in connection.peers),
    )


def _called(
    owner: bridge.Bridge,
    connection: bridge.RosServiceConnection | bridge.RosActionConnection,
    message: str,
) -> DeclaredConnection:
    """Returns a connection with a ROS service or action, which has neither topics nor a rate."""
    return DeclaredConnection(
        bridge=node_of(owner),
        name=str(connection.name),
        jaus_id=str(owner.address),
        rate=None,
        direction="to ROS" if connection.direction.name == "jausToRos" else "to JAUS",
        topics=(),
        message=message,
        is_report=False,
        peers=tuple(str(each.address) for each in connection.peers),
    )


def node_of(owner: bridge.Bridge) -> str:
    """Returns the full name of the ROS node of a bridge."""
    return resolve_topic(str(owner.name), owner.namespace or "", "")


def _full_name(kind: ros.MessageType) -> str:
    return f"{package_of(kind)}/msg/{kind.name}"
