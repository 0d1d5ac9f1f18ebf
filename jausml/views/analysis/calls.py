"""Calls of ROS services and goals of ROS actions, as a report tells of them.

They come when somebody asks, so no rate and no load is worked out for them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.semantics import calls
from jausml.language.semantics.list_drivers import driver_messages

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.metamodel.classes import bridge, jaus


@dataclass(frozen=True)
class CallReport:
    """A connection with a ROS service or a ROS action.

    Attributes:
        kind: `service` or `action`.
        messages: Names of the JAUS messages that are exchanged; for an action those of the
            list driver, and what an element of a list holds.
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
            _peers(service),
            float(service.timeout),
        )
    for action in owner.actionConnections:
        driver = driver_messages(action.driver)
        known = (driver.execute, driver.query, driver.report) if driver is not None else ()
        yield CallReport(
            str(action.name),
            str(action.direction.name),
            "action",
            str(action.action),
            str(action.type.name),
            _names((action.element.message, *known)),
            _peers(action),
            float(action.timeout),
        )


def _names(messages: Iterable[jaus.MessageDef]) -> tuple[str, ...]:
    return tuple(str(each.name) for each in messages)


def _peers(connection: bridge.RosServiceConnection | bridge.RosActionConnection) -> tuple[str, ...]:
    if connection.search is not None:
        return ("who is found",)
    return tuple(str(each.name) for each in connection.peers)
