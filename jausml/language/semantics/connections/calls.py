"""Calls of ROS services and actions, list drivers (AS5710), and what a bridge leaves unanswered."""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import (
    Answer,
    answer_alike,
    answer_by,
    command_answer,
    is_command,
    named,
)
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import code, query_name
from jausml.language.semantics.paths.attributes import PathFault
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place
from jausml.language.semantics.paths.ros_paths import RosPlace, ros_name
from jausml.language.semantics.paths.scopes import parse_path, spelled_out, target_paths
from jausml.language.semantics.subject import remembered

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
    return not is_to_ros(connection)


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
    candidates = (asking(connection), answering(connection), *connection.rejections)
    return [message for message in candidates if message is not None]


def types(connection: bridge.RosServiceConnection) -> tuple[ros.MessageType, ros.MessageType]:
    """Returns the ROS types of request and response."""
    return connection.type.request, connection.type.response


def member(owner: ros.MessageType, path: str) -> RosPlace | PathFault | None:
    """Returns the place of a member that is read by its name, which no element of a list is."""
    place = RosPlace(owner).follow(path)
    if isinstance(place, RosPlace) and ("[" in path or place.is_count):
        return PathFault(f"'{path}' of {ros_name(owner)} is within a list")
    return place


def maps_success(connection: bridge.RosServiceConnection) -> bool:
    """Tells whether the map of the response fills the member that says whether all went well."""
    map_ = connection.response
    if map_ is None or not connection.successMember:
        return False
    success = parse_path(connection.successMember)
    return any(
        parse_path(path) == success
        for assignment in spelled_out(map_, to_ros=True)
        if not isinstance(assignment, bridge.Ignore)
        for path in target_paths(assignment)
    )


def as_connection(connection: bridge.RosServiceConnection, half: Half) -> bridge.Connection:
    """Returns a half as a connection, which is in no model: it is translated like one."""
    half_connection = bridge.Connection()
    half_connection.name = f"{connection.name}_{half.kind}"
    half_connection.map = half.map
    # The directions are the defaults of the two classes.
    half_connection.direction = (
        bridge.Connection() if half.to_ros else bridge.RosServiceConnection()
    ).direction
    half_connection.outOfRange = connection.outOfRange
    return half_connection


def of_elements(action: bridge.RosActionConnection) -> bridge.Connection:
    """Returns the connection that carries single elements of a list; it is no part of the model."""
    connection = bridge.Connection()
    connection.name, connection.documentation = action.name, action.documentation
    connection.direction, connection.map, connection.outOfRange = (
        action.direction,
        action.element,
        action.outOfRange,
    )
    return connection


EXECUTE, QUERY, REPORT = "ExecuteList", "QueryActiveElement", "ReportActiveElement"
LIST_MANAGER = "ListManager"
RUN, MISSION_QUERY, MISSION_REPORT = "RunMission", "QueryMissionStatus", "ReportMissionStatus"
SPOOLER = ("SpoolMission", "AbortMission", "PauseMission", "ResumeMission")
"""The further messages that a mission spooler takes."""
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

WAYPOINTS = {
    "urn:jaus:jss:mobility:GlobalWaypointDriver": 0x040C,
    "urn:jaus:jss:mobility:LocalWaypointDriver": 0x040D,
}
"""Code of what sets the only waypoint of a driver (AS6009), which is executed as a list of one."""

PATH_SEGMENTS = frozenset({0x040F, 0x0410})
"""Codes of elements that are ways between points, and no points."""


@dataclass(frozen=True)
class DriverMessages:
    """The messages of a list driver.

    Attributes:
        execute: What has a list executed, or sets a single waypoint.
        report: What tells of the list, or the waypoint.
        spooler: What a mission spooler takes besides, in the order of SPOOLER.
        is_single: Whether it is a single waypoint.
    """

    execute: jaus.MessageDef
    query: jaus.MessageDef
    report: jaus.MessageDef
    spooler: tuple[jaus.MessageDef, ...] = ()
    is_single: bool = False

    @property
    def all(self) -> tuple[jaus.MessageDef, ...]:
        """All of them, as the runtime takes them."""
        return (self.execute, self.query, self.report, *self.spooler)


def driver_messages(service: jaus.Service | None) -> DriverMessages | None:
    """Returns the messages of a list driver; None when a service is none."""
    if service is not None and str(service.urn) in WAYPOINTS:
        return _waypoint_messages(service)
    services = lineage(service)
    inputs = [message for ancestor in services for message in ancestor.inputs]
    outputs = [message for ancestor in services for message in ancestor.outputs]
    spooler = tuple(message for name in SPOOLER if (message := named(name, inputs)) is not None)
    if any(ancestor.name == LIST_MANAGER for ancestor in services):
        spooler = ()
        candidates = named(EXECUTE, inputs), named(QUERY, inputs), named(REPORT, outputs)
    elif len(spooler) == len(SPOOLER):
        candidates = (
            named(RUN, inputs),
            named(MISSION_QUERY, inputs),
            named(MISSION_REPORT, outputs),
        )
    else:
        return None
    execute, query, report = candidates
    if execute is None or query is None or report is None:
        return None
    return DriverMessages(execute, query, report, spooler)


def _waypoint_messages(service: jaus.Service) -> DriverMessages | None:
    wanted = WAYPOINTS[str(service.urn)]
    command = next((message for message in service.inputs if code(message) == wanted), None)
    answer = None if command is None else answer_alike(service, command)
    if command is None or answer is None:
        return None
    return DriverMessages(command, answer.query, answer.report, is_single=True)


def speed_answer(driver: jaus.Service) -> Answer | None:
    """Returns the answer with the speed of a driver; None when it has none."""
    messages = driver_messages(driver)
    if messages is None or not knows_speed(messages):
        return None
    outputs = (message for service in lineage(driver) for message in service.outputs)
    return answer_by(driver, named(SPEED_REPORT, outputs))


def answers(action: bridge.RosActionConnection) -> list[Answer]:
    """Returns the answers of a bridge that is a list driver, besides ReportActiveElement."""
    if not is_to_ros(action):
        return []
    messages = driver_messages(action.driver)
    if messages is not None and messages.is_single:
        return []
    candidates = (speed_answer(action.driver), answer_alike(action.driver, action.element.message))
    return [answer for answer in candidates if answer is not None]


def knows_speed(messages: DriverMessages) -> bool:
    """Tells whether ExecuteList of a driver has a speed; that of manipulators has none."""
    return isinstance(message_place(messages.execute).follow("Speed"), JausPlace)


def takes(service: jaus.Service, message: jaus.MessageDef) -> bool:
    """Tells whether the list of a driver may hold a message; drivers outside the standard any."""
    expected = (ELEMENTS | WAYPOINTS).get(str(service.urn))
    return expected is None or code(message) == expected


def unanswered(service: jaus.Service, sent: Container[int]) -> list[jaus.MessageDef]:
    """Returns the queries of a service without a report, inherited ones left out."""
    if str(service.urn) in SERVED_BY_RUNTIME:
        return []
    # A service may send a report for which one that it inherits has the query.
    asked = {message.name: message for ancestor in lineage(service) for message in ancestor.inputs}
    reports = (output for output in service.outputs if code(output) not in sent)
    queries = (asked.get(query_name(report)) for report in reports)
    return [message for message in queries if message is not None]


def untaken(owner: bridge.Bridge) -> list[jaus.MessageDef]:
    """Returns the commands of a bridge's services that it does not take: services define more."""
    taken = {code(message) for message in _taken(owner)}
    return [
        message
        for service in owner.provides
        # A machine may take what no connection carries.
        if str(service.urn) not in SERVED_BY_RUNTIME and not service.machines
        for message in service.inputs
        if is_command(message) and code(message) not in taken
    ]


def _taken(owner: bridge.Bridge) -> Iterator[jaus.MessageDef]:
    """Yields the messages that connections of a bridge take from JAUS."""
    yield from (connection.map.message for connection in owner.bridgeConnections)
    for call in owner.serviceConnections:
        yield from messages(call)
    for action in owner.actionConnections:
        of_driver = driver_messages(action.driver)
        if of_driver is not None:
            yield from (action.element.message, *of_driver.all)


def sent_reports(owner: bridge.Bridge) -> set[int]:
    """Returns the codes of the reports that a bridge answers with."""
    commands = map(command_answer, owner.bridgeConnections)
    return {
        *_carried_codes(owner),
        *(code(command.report) for command in commands if command is not None),
    }


def told_command(connection: bridge.Connection) -> Answer | None:
    """Returns the answer with the present command of a connection, if no other one has it."""
    answer, owner = command_answer(connection), connection.eContainer()
    if answer is None or owner is None:
        return None
    return None if code(answer.report) in _carried_codes(owner) else answer


@remembered
def _carried_codes(owner: bridge.Bridge) -> frozenset[int]:
    return frozenset(map(code, _carried(owner)))


def _carried(owner: bridge.Bridge) -> Iterator[jaus.MessageDef]:
    """Yields the messages that connections of a bridge send to whoever asks."""
    for connection in owner.bridgeConnections:
        if not is_to_ros(connection) and connection.exchange.name != "message":
            yield connection.map.message
    for call in owner.serviceConnections:
        yield from messages(call)
    for action in owner.actionConnections:
        of_driver = driver_messages(action.driver)
        if of_driver is not None:
            yield of_driver.report
        yield from (answer.report for answer in answers(action))
