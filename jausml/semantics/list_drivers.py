"""List drivers: services that execute the list of a ListManager (AS5710)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.semantics.jaus_paths import JausPlace, message_place
from jausml.semantics.services import code, lineage

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.metamodel.classes import jaus

EXECUTE, QUERY, REPORT = "ExecuteList", "QueryActiveElement", "ReportActiveElement"
LIST_MANAGER = "ListManager"

ELEMENTS = {
    "urn:jaus:jss:mobility:GlobalWaypointListDriver": 0x040C,
    "urn:jaus:jss:mobility:LocalWaypointListDriver": 0x040D,
    "urn:jaus:jss:mobility:GlobalPathSegmentDriver": 0x040F,
    "urn:jaus:jss:mobility:LocalPathSegmentDriver": 0x0410,
    "urn:jaus:jss:manipulator:ManipulatorJointPositionsListDriver": 0x0602,
    "urn:jaus:jss:manipulator:ManipulatorEndEffectorPoseListDriver": 0x0610,
}
"""Code of what an element holds, by the driver (AS6009, AS6057); the runtime has the same."""


@dataclass(frozen=True)
class DriverMessages:
    """The messages of a list driver.

    Attributes:
        execute: Begins with a list.
        query: Asks for the element that is executed.
        report: Names it.
    """

    execute: jaus.MessageDef
    query: jaus.MessageDef
    report: jaus.MessageDef


def driver_messages(service: jaus.Service | None) -> DriverMessages | None:
    """Returns the messages of a list driver; None when a service is none.

    Args:
        service: The service.
    """
    services = lineage(service)
    if not any(each.name == LIST_MANAGER for each in services):
        return None
    execute = _named(EXECUTE, (m for each in services for m in each.inputs))
    query = _named(QUERY, (m for each in services for m in each.inputs))
    report = _named(REPORT, (m for each in services for m in each.outputs))
    if execute is None or query is None or report is None:
        return None
    return DriverMessages(execute, query, report)


def knows_speed(messages: DriverMessages) -> bool:
    """Tells whether ExecuteList of a driver has a speed; that of manipulators has none.

    Args:
        messages: Its messages.
    """
    return isinstance(message_place(messages.execute).follow("Speed"), JausPlace)


def takes(service: jaus.Service, message: jaus.MessageDef) -> bool:
    """Tells whether the list of a driver may hold a message; of drivers of one's own any.

    Args:
        service: The driver.
        message: What an element of the list holds.
    """
    expected = ELEMENTS.get(str(service.urn))
    return expected is None or code(message) == expected


def _named(name: str, messages: Iterable[jaus.MessageDef]) -> jaus.MessageDef | None:
    return next((each for each in messages if each.name == name), None)
