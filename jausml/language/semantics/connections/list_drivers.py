"""Services that execute a list: that of a ListManager (AS5710), or a mission (AS6062)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.semantics.jaus.answers import Answer, answer_alike, answer_by, named
from jausml.language.semantics.jaus.services import code, lineage
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge, jaus

EXECUTE, QUERY, REPORT = "ExecuteList", "QueryActiveElement", "ReportActiveElement"
LIST_MANAGER = "ListManager"
RUN, MISSION_QUERY, MISSION_REPORT = "RunMission", "QueryMissionStatus", "ReportMissionStatus"
SPOOLER = ("SpoolMission", "AbortMission", "PauseMission", "ResumeMission")
"""What a mission spooler takes besides."""
SPEED_REPORT = "ReportTravelSpeed"

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
        spooler: What a mission spooler takes besides, in the order of SPOOLER.
    """

    execute: jaus.MessageDef
    query: jaus.MessageDef
    report: jaus.MessageDef
    spooler: tuple[jaus.MessageDef, ...] = ()

    @property
    def all(self) -> tuple[jaus.MessageDef, ...]:
        """Each of them, as the runtime takes them."""
        return (self.execute, self.query, self.report, *self.spooler)


def driver_messages(service: jaus.Service | None) -> DriverMessages | None:
    """Returns the messages of a list driver; None when a service is none."""
    services = lineage(service)
    inputs = [m for each in services for m in each.inputs]
    outputs = [m for each in services for m in each.outputs]
    spooler = tuple(m for name in SPOOLER if (m := named(name, inputs)) is not None)
    if any(each.name == LIST_MANAGER for each in services):
        spooler = ()
        found = named(EXECUTE, inputs), named(QUERY, inputs), named(REPORT, outputs)
    elif len(spooler) == len(SPOOLER):
        found = named(RUN, inputs), named(MISSION_QUERY, inputs), named(MISSION_REPORT, outputs)
    else:
        return None
    execute, query, report = found
    if execute is None or query is None or report is None:
        return None
    return DriverMessages(execute, query, report, spooler)


def speed_answer(driver: jaus.Service) -> Answer | None:
    """Returns how a driver tells its speed; None when it knows none, or is not asked."""
    messages = driver_messages(driver)
    if messages is None or not knows_speed(messages):
        return None
    outputs = (m for each in lineage(driver) for m in each.outputs)
    return answer_by(driver, named(SPEED_REPORT, outputs))


def answers(action: bridge.RosActionConnection) -> list[Answer]:
    """Returns what a bridge that is a list driver answers besides QueryActiveElement."""
    if action.direction.name != "jausToRos":
        return []
    found = (speed_answer(action.driver), answer_alike(action.driver, action.element.message))
    return [each for each in found if each is not None]


def knows_speed(messages: DriverMessages) -> bool:
    """Tells whether ExecuteList of a driver has a speed; that of manipulators has none."""
    return isinstance(message_place(messages.execute).follow("Speed"), JausPlace)


def takes(service: jaus.Service, message: jaus.MessageDef) -> bool:
    """Tells whether the list of a driver may hold a message; of drivers of one's own any."""
    expected = ELEMENTS.get(str(service.urn))
    return expected is None or code(message) == expected
