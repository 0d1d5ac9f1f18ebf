"""Tasks of the Intelligent Ground Vehicle Competition: its JAUS challenge, as published in 2011.

The rules give points for a whole task, and 2.5 for each waypoint; how a task is divided is ours.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot
from typing import TYPE_CHECKING

from jausml.live.peers.conformance import lists
from jausml.live.peers.conformance.access import ACCEPTED, LOW, request
from jausml.live.peers.conformance.check import Check, step
from jausml.live.peers.conformance.management import READY, STANDBY, comes_to, is_down
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    ask,
    expect,
    expect_none,
    has,
    ready,
    send,
    usual,
)
from jausml.live.peers.discovery import services_of
from jausml.live.peers.judging.competition import Competition, Part, Task
from jausml.live.peers.judging.driving import Course, Drive
from jausml.live.peers.judging.message_steps import Topic, asks, goes_on, holds, sends, told
from jausml.runtime import messages as core
from jausml.runtime.services.discovery_messages import query_all_services

if TYPE_CHECKING:
    from jausml.live.peers.conformance.check import Step
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.base.settings import Endpoint

RULES = "IGVC 2011, JAUS Challenge"

INTERVAL = 5.0
"""Seconds between two questions of an entry that is not answered."""

_LENIENCE = 1.0
_FASTEST = 5.0
_NEAR = 0.25
_SET_WITHIN = 2.0

VELOCITY = Topic("VelocityStateSensor", "VelocityState", presence=0x0140)
VELOCITY_IN_WORDS = Topic("VelocityStateSensor", "VelocityState", presence=0x0141)
POSE = Topic("LocalPoseSensor", "LocalPose", presence=0x0103)

SERVICES = (
    "core:Discovery",
    "core:AccessControl",
    "core:Management",
    "mobility:VelocityStateSensor",
    "mobility:LocalPoseSensor",
    "mobility:LocalWaypointListDriver",
)
"""What the tasks need, by the ends of the URNs."""


@dataclass
class Handshake:
    """The questions of an entry that introduces itself.

    Attributes:
        asked: When they came, in seconds.
        place: Where they came from.
    """

    asked: list[float] = field(default_factory=list)
    place: Endpoint | None = None

    def hears(self, session: Session) -> None:
        """The entry asks for our identification without having been asked anything."""
        within = INTERVAL + _LENIENCE
        session.latest = f"{within:g} s of silence"
        received = self._next(session, within)
        session.require(received, f"no QueryIdentification came in {within:g} s")
        self.place = session.probe.endpoint

    def hears_again(self, session: Session) -> None:
        """The entry asks again after the interval."""
        came = self._next(session, INTERVAL + 2 * _LENIENCE)
        session.require(came, "the question is not repeated although it was not answered")
        pause = self.asked[-1] - self.asked[-2]
        session.require(
            abs(pause - INTERVAL) <= _LENIENCE,
            f"the question came again after {pause:.1f} s instead of {INTERVAL:g}",
        )

    def same_place(self, session: Session) -> None:
        """The entry answers from the address and port from which it asked."""
        place = session.probe.endpoint
        session.require(
            self.place in (None, place), f"it asked from {self.place} and answers from {place}"
        )

    def _next(self, session: Session, seconds: float) -> bool:
        client = session.first
        arrived = session.probe.wait(
            lambda: any(each.code == core.QueryIdentification.CODE for each in client.inbox),
            seconds,
        )
        if arrived:
            found = client.first_of((core.QueryIdentification.CODE,))
            self.asked += [found.time] if found else []
        return arrived


def jaus_challenge(course: Course) -> Competition:
    """Returns the tasks of the JAUS challenge."""
    return Competition(
        "igvc-jaus",
        "IGVC JAUS Challenge",
        f"{RULES}: six tasks of 10 points each. The division of a task is ours, but for the 2.5 "
        "points of a waypoint: 1 for reaching it, 1.5 for what the rules want told on the way.",
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
            "the time from the start box, which breaks ties; the time of the drive is told",
            "whether the vehicle was where it says: reached is what it reports, within 0.5 m",
        ),
    )


def _transport_discovery() -> Task:
    handshake = Handshake()
    return Task(
        "discovery",
        "Transport discovery",
        "The entry asks the judge for its identification every 5 seconds until it is answered, and "
        "then answers the same question.",
        (
            _part("discovery.greets", "Asks for identification by itself", 4, handshake.hears),
            _part(
                "discovery.repeats",
                "Asks every 5 s until it is answered",
                2,
                handshake.hears_again,
                needs=("greets",),
            ),
            _part(
                "discovery.stops",
                "Asks no more once it is answered",
                2,
                send(A, core.ReportIdentification(2, 10001, "jausml judge")),
                expect_none(
                    A,
                    core.QueryIdentification,
                    "the question was answered",
                    within=INTERVAL + _LENIENCE,
                ),
                needs=("greets",),
            ),
            _part(
                "discovery.identifies",
                "Identifies itself in return",
                2,
                ask(
                    A,
                    core.QueryIdentification(query_type=4),
                    core.ReportIdentification,
                    has(query_type=4),
                    usual(identification=AnythingBut("")),
                ),
                handshake.same_place,
            ),
        ),
        is_unasked=True,
    )


def _capabilities_discovery() -> Task:
    return Task(
        "capabilities",
        "Capabilities discovery",
        "QueryServices is answered with ReportServices, which holds what the tasks need, all of it "
        "under the one id of the entry.",
        (
            _part("capabilities.services", "Reports its services", 4, _own_services),
            *(
                _part(
                    f"capabilities.{each.partition(':')[2]}",
                    f"Lists {each.partition(':')[2]}",
                    1,
                    _lists(each),
                    needs=("services",),
                )
                for each in SERVICES
            ),
        ),
    )


def _own_services(session: Session) -> None:
    report = session.first.ask(query_all_services(), core.ReportServices)
    target = session.probe.target
    found = services_of(report, target.subsystem)
    session.require(target in found, f"ReportServices does not hold {target} itself")
    session.services = found[target]


def _lists(ending: str) -> Step:
    def judge(session: Session) -> None:
        urn = f"urn:jaus:jss:{ending}"
        session.require(
            any(each.urn == urn for each in session.services), f"ReportServices lacks {urn}"
        )

    return judge


def _system_management() -> Task:
    return Task(
        "management",
        "System management",
        "Control is asked for and given, the status is told, and Resume, Standby and Shutdown are "
        "obeyed. Shutdown comes after all other tasks.",
        (
            _part(
                "management.control",
                "Says who controls it",
                2,
                ask(A, core.QueryControl(), core.ReportControl),
            ),
            _part("management.request", "Gives control", 2, request(A, LOW, ACCEPTED)),
            _part(
                "management.status",
                "Reports its status",
                2,
                ask(
                    A,
                    core.QueryStatus(),
                    core.ReportStatus,
                    has(status=(STANDBY, READY)),
                    usual(reserved=0),
                ),
            ),
            _part(
                "management.resume",
                "Obeys Resume",
                2,
                send(A, core.Resume()),
                comes_to(READY),
                needs=("request", "status"),
            ),
            _part(
                "management.standby",
                "Obeys Standby",
                1,
                send(A, core.Standby()),
                comes_to(STANDBY),
                needs=("resume",),
            ),
            _part(
                "management.shutdown",
                "Obeys Shutdown",
                1,
                ready(A),
                send(A, core.Shutdown()),
                is_down,
                needs=("resume",),
                is_last=True,
            ),
        ),
    )


def _velocity() -> Task:
    return Task(
        "velocity",
        "Velocity state report",
        "QueryVelocityState is answered. The rules name velocity X, yaw rate and time stamp, and "
        "the presence vector 320 (0140h), which leaves velocity X out; both are asked for.",
        (
            _part(
                "velocity.report",
                "Reports yaw rate and time stamp (0140h)",
                4,
                asks(A, VELOCITY, holds("YawRate", "TimeStamp")),
            ),
            _part(
                "velocity.forward",
                "Reports velocity X too (0141h)",
                3,
                asks(A, VELOCITY_IN_WORDS, holds("Velocity_X", "YawRate", "TimeStamp")),
                needs=("report",),
            ),
            _part(
                "velocity.time",
                "Its time stamps go on",
                3,
                goes_on(A, VELOCITY, 1.0, _FASTEST),
                needs=("report",),
            ),
        ),
    )


def _position() -> Task:
    return Task(
        "position",
        "Position and orientation report",
        "SetLocalPose sets X, Y and yaw (0043h), and QueryLocalPose is answered with X, Y and time "
        "stamp (0103h), such that a vehicle can have moved so.",
        (
            _part(
                "position.report",
                "Reports X, Y and time stamp (0103h)",
                4,
                asks(A, POSE, holds("X", "Y", "TimeStamp")),
            ),
            _part(
                "position.time",
                "Its time stamps go on, and its position does not jump",
                3,
                goes_on(A, POSE, 1.0, _FASTEST),
                needs=("report",),
            ),
            _part(
                "position.set",
                "Obeys SetLocalPose",
                3,
                ready(A),
                *_set_to(3.0, -2.0, 0.5),
                *_set_to(0.0, 0.0, 0.0),
                needs=("report",),
            ),
        ),
    )


def _set_to(x: float, y: float, yaw: float) -> tuple[Step, ...]:
    return (
        sends(A, "LocalPoseSensor", "SetLocalPose", X=x, Y=y, Yaw=yaw),
        _is_at(x, y),
    )


@step
def _is_at(session: Session, x: float, y: float) -> None:
    end = session.probe.now() + _SET_WITHIN
    while True:
        found = session.first.asked(POSE.query(session), POSE.report(session))
        session.require(found is not None, "QueryLocalPose is not answered after SetLocalPose")
        place = told(found) if found is not None else {}
        off = hypot(place.get("X", x + 99) - x, place.get("Y", y) - y)
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
    source = f"{rules}, Waypoint navigation; AS6009 LocalWaypointListDriver"
    count = len(drive.uids)
    share = 10 / count
    told_share = 0.2 * share * count
    return Task(
        "waypoints",
        "Waypoint navigation",
        f"A list of {count} waypoints is set, asked for, executed at 1 m/s, and driven in order. "
        "Not executed is a list that was not taken as it was sent.",
        (
            _part(
                "waypoints.list",
                "Takes the list: SetElement, QueryElementList, QueryElementCount",
                0,
                lists.empty(),
                ready(A),
                send(A, drive.list_of),
                expect(A, core.ConfirmElementRequest, has(request_id=1)),
                lists.holds(*drive.uids),
                ask(A, core.QueryElementCount(), core.ReportElementCount, has(element_count=count)),
                source=source,
            ),
            _part(
                "waypoints.drive",
                "Executes the list",
                0,
                drive.execute,
                needs=("list",),
                source=source,
            ),
            *(
                _part(
                    f"waypoints.reached-{number}",
                    f"Reaches waypoint {number} in its turn",
                    0.4 * share,
                    drive.reaches(number),
                    needs=("drive",),
                    source=source,
                )
                for number in drive.uids
            ),
            _part(
                "waypoints.active",
                "Names the active element on the way",
                told_share,
                drive.names_active,
                needs=("drive",),
                source=source,
            ),
            _part(
                "waypoints.speed",
                "Reports its travel speed on the way",
                told_share,
                drive.tells_speed,
                needs=("drive",),
                source=source,
            ),
            _part(
                "waypoints.waypoint",
                "Reports the local waypoint that it drives to",
                told_share,
                drive.tells_waypoint,
                needs=("drive",),
                source=source,
            ),
        ),
    )


def _part(
    check_id: str,
    title: str,
    points: float,
    *steps: Step,
    needs: tuple[str, ...] = (),
    is_last: bool = False,
    source: str = "",
) -> Part:
    rule = source or f"{RULES}; {_CLAUSES[check_id.partition('.')[0]]}"
    return Part(Check(check_id, title, rule, title, steps), points, needs, is_last)


_CLAUSES = {
    "discovery": "AS5710A Discovery, QueryIdentification, ReportIdentification",
    "capabilities": "AS5710A Discovery, QueryServices, ReportServices",
    "management": "AS5710A AccessControl and Management, protocol behaviour",
    "velocity": "AS6009 VelocityStateSensor, QueryVelocityState, ReportVelocityState",
    "position": "AS6009 LocalPoseSensor, SetLocalPose, QueryLocalPose, ReportLocalPose",
}
