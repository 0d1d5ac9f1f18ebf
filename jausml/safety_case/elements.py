"""Elements of a model that hazards concern: those that command, carry and report."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias, cast

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.connections.reports import is_report
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.paths.scopes import sound_connections
from jausml.language.semantics.subject import Subject

Commander: TypeAlias = "bridge.Connection | bridge.RosActionConnection"
Carrier: TypeAlias = "Commander | bridge.RosServiceConnection"


def carried_maps(element: object) -> list[bridge.AttributeMap]:
    """Returns the maps of a connection, none of other elements."""
    carriers = (bridge.Connection, bridge.RosServiceConnection, bridge.RosActionConnection)
    return [map_ for map_, _ in map_directions(element)] if isinstance(element, carriers) else []


def map_directions(carrier: Carrier) -> list[tuple[bridge.AttributeMap, bool]]:
    """Returns the maps of a connection, each with whether it leads to ROS."""
    if isinstance(carrier, bridge.RosServiceConnection):
        return [(half.map, half.to_ros) for half in calls.halves(carrier)]
    map_ = carrier.map if isinstance(carrier, bridge.Connection) else carrier.element
    return [(map_, is_to_ros(carrier))]


def bridge_of(carrier: Carrier) -> bridge.Bridge:
    """Returns the bridge of a connection."""
    return cast("bridge.Bridge", carrier.eContainer())


def moving_inputs(component: jaus.Component) -> Iterator[tuple[jaus.MessageDef, jaus.Service]]:
    """Yields the commands of users' services that move a component, each with its service."""
    for service in with_inherited(component.provides):
        if str(service.urn) not in SERVED_BY_RUNTIME:
            yield from (
                (message, service)
                for message in service.inputs
                if is_command(message) and message.moves
            )


def commands_to_ros(subject: Subject) -> list[Commander]:
    """Returns the connections that carry commands to ROS, lists to drive along included."""
    return [commander for commander in _commanders(subject) if is_to_ros(commander)]


def commands_to_jaus(subject: Subject) -> list[Commander]:
    """Returns the connections that carry commands to JAUS, lists to drive along included."""
    return [commander for commander in _commanders(subject) if not is_to_ros(commander)]


def jaus_messages(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections of messages that carry commands to JAUS."""
    return [connection for connection in _commanding(subject) if not is_to_ros(connection)]


def aging(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections to ROS, and those that carry commands."""
    return [
        connection
        for connection in sound_connections(subject)
        if is_to_ros(connection) or stops.carries_commands(connection)
    ]


def taken_messages(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections to ROS of messages that peers send unasked."""
    connections = sound_connections(subject)
    return [
        connection
        for connection in connections
        if is_to_ros(connection) and connection.exchange.name == "message"
    ]


def published(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections to ROS that carry no commands."""
    return [
        connection
        for connection in sound_connections(subject)
        if is_to_ros(connection) and not stops.carries_commands(connection)
    ]


def reports(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections that report to JAUS."""
    return [connection for connection in sound_connections(subject) if is_report(connection)]


def carriers(subject: Subject) -> list[Carrier]:
    """Returns all connections between ROS and JAUS."""
    calls_ = subject.instances(bridge.RosServiceConnection)
    return [*sound_connections(subject), *calls_, *subject.instances(bridge.RosActionConnection)]


def commandable(subject: Subject) -> list[Carrier]:
    """Returns the connections by which JAUS may command ROS, calls included."""
    commanding = []
    for ros_service_connection in subject.instances(bridge.RosServiceConnection):
        asking = calls.asking(ros_service_connection)
        if is_to_ros(ros_service_connection) and asking is not None and is_command(asking):
            commanding.append(ros_service_connection)
    return [*commands_to_ros(subject), *commanding]


def moved_components(subject: Subject) -> list[jaus.Component]:
    """Returns the own components beside bridges that obey commands which move them."""
    components = (
        component for component in subject.instances(jaus.Component) if not component.external
    )
    return [
        component
        for component in components
        if not isinstance(component, bridge.Bridge) and any(moving_inputs(component))
    ]


def asking(subject: Subject) -> list[jaus.ServiceConnection]:
    """Returns the connections by which components ask each other."""
    return subject.instances(jaus.ServiceConnection)


def bridges(subject: Subject) -> list[bridge.Bridge]:
    """Returns all bridges."""
    return subject.instances(bridge.Bridge)


def _commanding(subject: Subject) -> list[bridge.Connection]:
    return [
        connection
        for connection in sound_connections(subject)
        if stops.carries_commands(connection)
    ]


def _commanders(subject: Subject) -> list[Commander]:
    return [*_commanding(subject), *subject.instances(bridge.RosActionConnection)]
