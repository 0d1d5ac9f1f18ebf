"""Drive along a list of waypoints, and what the target tells on the way."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot
from typing import TYPE_CHECKING, Any

from jausml.live.messages import MessageError
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.judging.message_steps import Topic, made, told
from jausml.runtime.messages import SetElement
from jausml.runtime.services.element_list import chain

if TYPE_CHECKING:
    from jausml.live.peers.conformance.check import Step
    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.session import Session

DRIVER = "LocalWaypointListDriver"
ACTIVE = Topic(DRIVER, "ActiveElement")
SPEED = Topic(DRIVER, "TravelSpeed")
WAYPOINT = Topic(DRIVER, "LocalWaypoint", presence=0)
POSE = Topic("LocalPoseSensor", "LocalPose", presence=3)

RADIUS = 0.5
"""Metres within which a waypoint counts as reached; the published rules name none."""

TRAVEL_SPEED = 1.0
"""Speed in m/s of ExecuteList, as the rules have it."""

_PERIOD = 0.2
_PATIENCE = 3.0
_CLOSE = 0.01


@dataclass(frozen=True)
class Course:
    """Where the target is to drive.

    Attributes:
        waypoints: x and y in metres, in the local frame of the target: x forward, y right.
        seconds: How long it may take from one to the next.
    """

    waypoints: tuple[tuple[float, float], ...] = ((2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0))
    seconds: float = 60.0


@dataclass(frozen=True)
class Sample:
    """What the target told at a time; None of what it did not tell.

    Attributes:
        time: Seconds since ExecuteList.
    """

    time: float
    active: int | None = None
    place: tuple[float, float] | None = None
    speed: float | None = None
    waypoint: tuple[float, float] | None = None


@dataclass
class Drive:
    """One drive along a course; its steps judge what was seen on it."""

    course: Course
    samples: list[Sample] = field(default_factory=list)

    def list_of(self, session: Session) -> SetElement:
        """Returns the request that sets the waypoints, under the UIDs 1, 2, and so on."""
        contents = [
            (uid, made(session, DRIVER, "SetLocalWaypoint", X=x, Y=y).encode(), 0)
            for uid, (x, y) in enumerate(self.course.waypoints, 1)
        ]
        records = [
            SetElement.ElementRec(
                each.uid,
                each.previous_uid,
                each.next_uid,
                SetElement.ElementData(each.data_format, each.data),
            )
            for each in chain(contents)
        ]
        return SetElement(SetElement.RequestIDRec(1), records)

    @property
    def uids(self) -> tuple[int, ...]:
        """The UIDs of the elements."""
        return tuple(range(1, len(self.course.waypoints) + 1))

    def execute(self, session: Session) -> None:
        """Has the list executed, and asks again and again until it ends or time is over."""
        execute = made(session, DRIVER, "ExecuteList", Speed=TRAVEL_SPEED, ElementUID=1)
        session.send(0, execute)
        begun = session.probe.now()
        self.samples.clear()
        while not self._is_over():
            self.samples.append(self._sample(session, begun))
        session.require(
            self._departure is not None or any(each.active for each in self.samples),
            "the list is not executed: no element is active, and nothing moves",
        )

    def _is_over(self) -> bool:
        """Whether no element is active any more, all are reached, or there is no time left."""
        if not self.samples:
            return False
        latest = self.samples[-1]
        arrivals = self.reached()
        if latest.active == 0 and (latest.time > _PATIENCE or any(e.active for e in self.samples)):
            return True
        if all(each is not None and latest.time - each.time > _PATIENCE for each in arrivals):
            return True
        return latest.time > self.course.seconds * len(self.uids)

    @property
    def _departure(self) -> int | None:
        """Returns the place of the first sample away from the start."""
        start = next((each.place for each in self.samples if each.place is not None), None)
        away = (
            at
            for at, each in enumerate(self.samples)
            if start and each.place and _distance(each.place, start) > RADIUS
        )
        return next(away, None)

    def _sample(self, session: Session, begun: float) -> Sample:
        client = session.first
        for topic in (ACTIVE, POSE, SPEED, WAYPOINT):
            client.send(topic.query(session))
        session.probe.wait(lambda: False, _PERIOD)
        active, pose = _latest(session, client, ACTIVE), _latest(session, client, POSE)
        speed, waypoint = _latest(session, client, SPEED), _latest(session, client, WAYPOINT)
        client.clear()
        return Sample(
            session.probe.now() - begun,
            active.get("ElementUID"),
            _place(pose),
            speed.get("Speed"),
            _place(waypoint),
        )

    def reached(self) -> list[Sample | None]:
        """Returns when each waypoint was reached, after those before it that were."""
        found: list[Sample | None] = []
        departure = self._departure
        since = len(self.samples) if departure is None else departure
        for goal in self.course.waypoints:
            rest = range(since, len(self.samples))
            at = next((each for each in rest if self._is_near(self.samples[each], goal)), None)
            found.append(None if at is None else self.samples[at])
            since = since if at is None else at
        return found

    def _is_near(self, sample: Sample, goal: tuple[float, float]) -> bool:
        return sample.place is not None and _distance(sample.place, goal) <= RADIUS

    # ---- what is judged ---------------------------------------------------------------------

    def reaches(self, number: int) -> Step:
        """The target was at a waypoint, after those before it."""

        def judge(session: Session) -> None:
            goal = self.course.waypoints[number - 1]
            found = self.reached()[number - 1]
            places = [each.place for each in self.samples if each.place is not None]
            if found is None and not places:
                raise CheckFailed("the target did not tell where it was")
            if found is None:
                nearest = min(_distance(each, goal) for each in places)
                raise CheckFailed(
                    f"not within {RADIUS} m of {goal[0]:g}, {goal[1]:g} in its turn; "
                    f"the nearest place of the drive was {nearest:.2f} m off"
                )
            session.trace.remark(f"at {goal[0]:g}, {goal[1]:g} after {found.time:.1f} s")

        return judge

    def names_active(self, session: Session) -> None:
        """The active elements were told in order, and none at the end."""
        seen = [each.active for each in self.samples if each.active is not None]
        session.require(bool(seen), "QueryActiveElement was not answered on the way")
        order = [uid for uid, former in zip(seen, [0, *seen], strict=False) if uid != former]
        if order != [*self.uids, 0]:
            raise CheckFailed(f"active elements were {order} instead of {[*self.uids, 0]}")

    def tells_speed(self, session: Session) -> None:
        """The speed of ExecuteList was told while the list was executed."""
        told_speeds = [each.speed for each in self._driving if each.speed is not None]
        session.require(bool(told_speeds), "QueryTravelSpeed was not answered on the way")
        wrong = [each for each in told_speeds if abs(each - TRAVEL_SPEED) > _CLOSE]
        if wrong:
            raise CheckFailed(f"ReportTravelSpeed said {wrong[0]:.3g} instead of {TRAVEL_SPEED}")

    def tells_waypoint(self, session: Session) -> None:
        """The waypoint that was told is that of the active element."""
        known = [each for each in self._driving if each.waypoint is not None]
        session.require(bool(known), "QueryLocalWaypoint was not answered on the way")
        for each in known:
            goals = self.course.waypoints if each.active is None else (self._goal(each.active),)
            if each.waypoint and min(_distance(each.waypoint, goal) for goal in goals) > _CLOSE:
                x, y = each.waypoint
                raise CheckFailed(
                    f"ReportLocalWaypoint said {x:g}, {y:g} while element {each.active} at "
                    f"{', '.join(f'{goal[0]:g}, {goal[1]:g}' for goal in goals)} was active"
                )

    def _goal(self, uid: int) -> tuple[float, float]:
        return self.course.waypoints[uid - 1]

    @property
    def _driving(self) -> list[Sample]:
        """The samples while a waypoint was driven to.

        Those between which the element changes tell the one or the other of two, and are left out.
        """
        steady = [
            each
            for before, each, after in zip(
                self.samples, self.samples[1:], self.samples[2:], strict=False
            )
            if before.active == each.active == after.active
        ]
        return [each for each in steady if each.active is None or each.active in self.uids]


def _latest(session: Session, client: Client, topic: Topic) -> dict[str, Any]:
    """Returns the fields of the last report of a topic that came; none without a good one."""
    kind = topic.report(session)
    for received in reversed(client.inbox):
        if received.code == kind.CODE:
            try:
                return told(kind(kind.ENTRY.decode(received.payload)))
            except MessageError:
                return {}
    return {}


def _place(report: dict[str, Any]) -> tuple[float, float] | None:
    return (report["X"], report["Y"]) if {"X", "Y"} <= report.keys() else None


def _distance(one: tuple[float, float], other: tuple[float, float]) -> float:
    return hypot(one[0] - other[0], one[1] - other[1])
