"""Calls of ROS services: which messages ask and answer, and the translations of both halves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.paths.scopes import parse_path, target_paths

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import jaus, ros

REQUEST = "request"
RESPONSE = "response"


@dataclass(frozen=True)
class Half:
    """A half of the calls of a service connection that a map translates."""

    kind: str
    map: bridge.AttributeMap
    to_ros: bool


def serves(connection: bridge.RosServiceConnection) -> bool:
    """Tells whether the bridge serves the ROS service; else it calls it."""
    return connection.direction.name == "rosToJaus"


def halves(connection: bridge.RosServiceConnection) -> Iterator[Half]:
    """Yields the halves of a service connection that have maps."""
    if connection.request is not None:
        yield Half(REQUEST, connection.request, to_ros=not serves(connection))
    if connection.response is not None:
        yield Half(RESPONSE, connection.response, to_ros=serves(connection))


def asking(connection: bridge.RosServiceConnection) -> jaus.MessageDef | None:
    """Returns the JAUS message that asks."""
    return connection.message if connection.request is None else connection.request.message


def answering(connection: bridge.RosServiceConnection) -> jaus.MessageDef | None:
    """Returns the JAUS message that answers; None where nothing does."""
    return connection.answer if connection.response is None else connection.response.message


def messages(connection: bridge.RosServiceConnection) -> list[jaus.MessageDef]:
    """Returns the JAUS messages of a service connection, without those inside them."""
    found = (asking(connection), answering(connection), *connection.rejections)
    return [each for each in found if each is not None]


def types(connection: bridge.RosServiceConnection) -> tuple[ros.MessageType, ros.MessageType]:
    """Returns the ROS types of request and response."""
    return connection.type.request, connection.type.response


def maps_success(connection: bridge.RosServiceConnection) -> bool:
    """Tells whether the map of the response fills the member that says whether all went well."""
    used = connection.response
    if used is None or not connection.successMember:
        return False
    member = parse_path(connection.successMember)
    return any(
        parse_path(path) == member
        for each in used.toRos
        if not isinstance(each, bridge.Ignore)
        for path in target_paths(each)
    )


def as_connection(connection: bridge.RosServiceConnection, half: Half) -> bridge.Connection:
    """Returns a half as a connection, which is in no model: it is translated like one."""
    made = bridge.Connection()
    made.name = f"{connection.name}_{half.kind}"
    made.map = half.map
    # The directions are the defaults of the two classes.
    made.direction = (
        bridge.Connection() if half.to_ros else bridge.RosServiceConnection()
    ).direction
    made.outOfRange = connection.outOfRange
    return made
