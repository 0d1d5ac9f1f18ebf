"""Tasks of the Intelligent Ground Vehicle Competition: its JAUS challenge, as published in 2011.

The rules give points for a whole task, and 2.5 for each waypoint; how a task is divided is ours.
"""

from __future__ import annotations

from math import hypot

from jausml.live.peers.conformance import lists
from jausml.live.peers.conformance.access import ACCEPTED, LOW, request
from jausml.live.peers.conformance.check import step
from jausml.live.peers.conformance.management import READY, STANDBY, comes_to, is_down
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    Judgement,
    ask,
    expect,
    expect_none,
    has,
    ready,
    send,
    should_have,
)
from jausml.live.peers.discovery import services_of
from jausml.live.peers.judging.competition import Competition, PartOf, Task, part, task
from jausml.live.peers.judging.driving import (
    DRIVER,
    RADIUS,
    TRAVEL_SPEED,
    Course,
    Drive,
    Topic,
    asks,
    fields_of,
    goes_on,
    holds,
    message_of,
)
from jausml.runtime import messages as core
from jausml.runtime.base.settings import Endpoint
from jausml.runtime.clients.discovery_client import query_services

RULES = "IGVC 2011, JAUS Challenge"

INTERVAL = 5.0  # seconds between two queries of an entry until it is answered

PATIENCE = 30.0  # seconds until the first query of an entry, which may just be starting

_LENIENCE = 1.0
_FASTEST = 5.0
_NEAR = 0.25
_SET_WITHIN = 2.0
_WAYPOINT_TASK = 10.0
_IDENTIFY = core.QueryIdentification(query_type=4)
_NAMED: Judgement[core.ReportIdentification] = should_have(identification=AnythingBut(""))
_FAR = float("inf")
_ONE_INTERVAL = INTERVAL + _LENIENCE

VELOCITY = Topic("VelocityStateSensor", "VelocityState", presence=0x0140)
VELOCITY_IN_WORDS = Topic("VelocityStateSensor", "VelocityState", presence=0x0141)
POSE = Topic("LocalPoseSensor", "LocalPose", presence=0x0103)

# The services that the tasks need.
SERVICES = (
    *("Discovery", "AccessControl", "Management"),
    *("VelocityStateSensor", "LocalPoseSensor", DRIVER),
)


class Handshake:
    """The queries of an entry that introduces itself: time and endpoint of the last one."""

    def __init__(self) -> None:
        self._heard = 0.0
        self._place: Endpoint | None = None

    def hears(self, session: Session) -> None:
        """The entry asks for our identification without having been asked anything."""
        self._hear(session, PATIENCE, f"no QueryIdentification came in {PATIENCE:g} s")
        self._place = session.probe.endpoint

    def hears_again(self, session: Session) -> None:
        """The entry asks again after the interval."""
        before = self._heard
        failure = "the question is not repeated although it was not answered"
        self._hear(session, _ONE_INTERVAL, failure)
        pause = self._heard - before
        session.require(
            abs(pause - INTERVAL) <= _LENIENCE,
            f"the question came again after {pause:.1f} s instead of {INTERVAL:g}",
        )

    def same_place(self, session: Session) -> None:
        """The entry answers from the address and port from which it asked."""
        place = session.probe.endpoint
        session.require(
            self._place in (None, place), f"it asked from {self._place} and answers from {place}"
        )

    def _hear(self, session: Session, seconds: float, failure: str) -> None:
        query = session.first.find(core.QueryIdentification, within=seconds)
        session.require(query is not None, failure)
        self._heard = session.probe.now()


def jaus_challenge(course: Course) -> Competition:
    """Returns the tasks of the JAUS challenge."""
    return Competition(
        "igvc-jaus",
        "IGVC JAUS Challenge",
        f"{RULES}: six tasks of 10 points each, the last with 2.5 for each of four waypoints. "
        "Further divisions are ours: of a waypoint 1 for reaching it, and 0.5 each for active "
        "element, travel speed and local waypoint told on the way.",
        (
            _transport_discovery(),
            _capabilities_discovery(),
            _system_management(),
            _velocity(),
            _position(),
            waypoint_navigation(course, RULES),
        ),
        (
            "the addresses of the event's network (192.168.1.x, UDP port 3794) and its radio link",
            "the time from the start box, which breaks ties; the times of the drive are told",
            f"whether the vehicle was where it says: it is believed, within {RADIUS} m",
        ),
    )


def _transport_discovery() -> Task:
    handshake = Handshake()
    return task(
        "discovery",
        "Transport discovery",
        "The entry asks the judge for its identification every 5 seconds until it is answered, and "
        "then answers the same question.",
        f"{RULES}; AS5710A Discovery, QueryIdentification, ReportIdentification",
        part("greets", 4, "Asks for identification by itself")(handshake.hears),
        part("repeats", 2, "Asks every 5 s until it is answered", "greets")(handshake.hears_again),
        part("stops", 2, "Asks no more once it is answered", "greets")(
            send(A, core.ReportIdentification(2, 10001, "jausml judge")),
            expect_none(A, core.QueryIdentification, "it was answered", within=_ONE_INTERVAL),
        ),
        part("identifies", 2, "Identifies itself in return, from where it asked")(
            ask(A, _IDENTIFY, core.ReportIdentification, has(query_type=4), _NAMED),
            handshake.same_place,
        ),
        is_unasked=True,
    )


def _capabilities_discovery() -> Task:
    return task(
        "capabilities",
        "Capabilities discovery",
        "QueryServices is answered with ReportServices, which holds what the tasks need, all of it "
        "under the one id of the entry.",
        f"{RULES}; AS5710A Discovery, QueryServices, ReportServices",
        part("services", 4, "Reports its services")(own_services),
        *(
            part(service, 1, f"Lists {service}", "services")(lists_service(service))
            for service in SERVICES
        ),
    )


def own_services(session: Session) -> None:
    """The target lists its services, which are those of the session from now on."""
    report = session.first.ask(query_services(), core.ReportServices)
    target = session.probe.target
    services = services_of(report, target.subsystem)
    session.require(target in services, f"ReportServices does not hold {target} itself")
    session.services = services[target]


@step
def lists_service(session: Session, name: str) -> None:
    """The target has listed a service of this name."""
    names = [service.urn.rpartition(":")[2] for service in session.services]
    session.require(name in names, f"ReportServices lacks {name}")


def _system_management() -> Task:
    return task(
        "management",
        "System management",
        "Control is asked for and given, the status is told, and Resume, Standby and Shutdown are "
        "obeyed. Shutdown comes after all other tasks.",
        f"{RULES}; AS5710A AccessControl and Management, protocol behaviour",
        part("control", 2, "Says who controls it")(ask(A, core.QueryControl(), core.ReportControl)),
        part("request", 2, "Gives control")(request(A, LOW, ACCEPTED)),
        part("status", 2, "Reports its status")(
            ask(A, core.QueryStatus(), core.ReportStatus, has(status=(STANDBY, READY)))
        ),
        part("resume", 2, "Obeys Resume", "request", "status")(
            send(A, core.Resume()), comes_to(READY)
        ),
        part("standby", 1, "Obeys Standby", "resume")(send(A, core.Standby()), comes_to(STANDBY)),
        part("shutdown", 1, "Obeys Shutdown", "resume", is_last=True)(
            ready(A), send(A, core.Shutdown()), is_down
        ),
    )


def _velocity() -> Task:
    return task(
        "velocity",
        "Velocity state report",
        "QueryVelocityState is answered. The rules name velocity X, yaw rate and time stamp, and "
        "the presence vector 320 (0140h), which leaves velocity X out; both are asked for.",
        f"{RULES}; AS6009 VelocityStateSensor, QueryVelocityState, ReportVelocityState",
        part("report", 4, "Reports yaw rate and time stamp (0140h)")(
            asks(A, VELOCITY, holds("YawRate", "TimeStamp"))
        ),
        part("forward", 3, "Reports velocity X too (0141h)", "report")(
            asks(A, VELOCITY_IN_WORDS, holds("Velocity_X", "YawRate", "TimeStamp"))
        ),
        part("time", 3, "Its time stamps go on", "report")(goes_on(A, VELOCITY, 1.0, _FASTEST)),
    )


def _position() -> Task:
    return task(
        "position",
        "Position and orientation report",
        "SetLocalPose sets X, Y and yaw (0043h), and QueryLocalPose is answered with X, Y and time "
        "stamp (0103h), such that a vehicle can have moved so.",
        f"{RULES}; AS6009 LocalPoseSensor, SetLocalPose, QueryLocalPose, ReportLocalPose",
        part("report", 4, "Reports X, Y and time stamp (0103h)")(
            asks(A, POSE, holds("X", "Y", "TimeStamp"))
        ),
        part("time", 3, "Its time stamps go on, and its position does not jump", "report")(
            goes_on(A, POSE, 1.0, _FASTEST)
        ),
        part("set", 3, "Obeys SetLocalPose", "report")(
            ready(A), _sets_pose(3.0, -2.0, 0.5), _sets_pose(0.0, 0.0, 0.0)
        ),
    )


@step
def _sets_pose(session: Session, x: float, y: float, yaw: float) -> None:
    """The target says that it is where it is told to be, after a while at the latest."""
    session.send(A, message_of(session, POSE.service, "SetLocalPose", X=x, Y=y, Yaw=yaw))
    end = session.probe.now() + _SET_WITHIN
    while True:
        pose = fields_of(session.first.ask(POSE.query(session), POSE.report(session)))
        off = hypot(pose.get("X", _FAR) - x, pose.get("Y", _FAR) - y)
        if off <= _NEAR:
            return
        session.require(
            session.probe.now() < end,
            f"{_SET_WITHIN:g} s after SetLocalPose to {x:g}, {y:g} the reported place is "
            f"{off:.2f} m off",
        )
        session.pause()


def waypoint_navigation(course: Course, rules: str) -> Task:
    """Returns the task of driving along a list of waypoints."""
    drive = Drive(course)
    count = len(drive.uids)
    share = _WAYPOINT_TASK / count
    return task(
        "waypoints",
        "Waypoint navigation",
        f"A list of {count} waypoints is set, asked for, executed at {TRAVEL_SPEED:g} m/s, and "
        "driven in order. A list that was not taken as it was sent is not executed.",
        f"{rules}; AS6009 {DRIVER}, AS5710A ListManager",
        part("list", 0, "Takes the list: SetElement, QueryElementList, QueryElementCount")(
            lists.empty(),
            ready(A),
            send(A, drive.list_of),
            expect(A, core.ConfirmElementRequest, has(request_id=1)),
            lists.holds(*drive.uids),
            ask(A, core.QueryElementCount(), core.ReportElementCount, has(element_count=count)),
        ),
        part("drive", 0, "Executes the list", "list")(drive.execute),
        *(
            waypoint_part
            for number in drive.uids
            for waypoint_part in _waypoint(drive, number, share)
        ),
    )


def _waypoint(drive: Drive, number: int, points: float) -> tuple[PartOf, ...]:
    """Returns the parts of a waypoint: reaching it, and the reports on the way to it."""
    reached, further = f"reached-{number}", 0.2 * points
    return (
        part(reached, 0.4 * points, f"Reaches waypoint {number} in its turn", "drive")(
            drive.reaches(number)
        ),
        part(f"active-{number}", further, f"Names element {number} as the active one", reached)(
            drive.names_active(number)
        ),
        part(f"speed-{number}", further, f"Reports the travel speed to {number}", reached)(
            drive.tells_speed(number)
        ),
        part(f"waypoint-{number}", further, f"Reports waypoint {number} on the way", reached)(
            drive.tells_waypoint(number)
        ),
    )
