"""Drive along a list of waypoints, and what the target tells on the way."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from jausml.live.messages import MessageError
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.judging.message_steps import Topic, made, told
from jausml.runtime.messages import SetElement
from jausml.runtime.services.element_list import chain

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jausml.live.peers.conformance.check import Step
    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.evidence import TraceLine
    from jausml.live.peers.conformance.session import Session

T = TypeVar("T")
Place: TypeAlias = tuple[float, float]
"""x and y in metres."""

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
_QUOTED = 3


@dataclass(frozen=True)
class Course:
    """Where the target is to drive.

    Attributes:
        waypoints: x and y in metres, in the local frame of the target: x forward, y right.
        seconds: How long it may take from one to the next.
    """

    waypoints: tuple[Place, ...] = ((2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0))
    seconds: float = 60.0


@dataclass(frozen=True)
class Sample:
    """What the target told at a time; None of what it did not tell.

    Attributes:
        time: Seconds since ExecuteList.
        evidence: What was sent and seen.
    """

    time: float
    active: int | None = None
    place: Place | None = None
    speed: float | None = None
    waypoint: Place | None = None
    evidence: tuple[TraceLine, ...] = ()


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
        """Whether the list has ended, all is reached, or the next waypoint takes too long."""
        if not self.samples:
            return False
        latest = self.samples[-1]
        ended = any(each.active for each in self.samples) or latest.time > _PATIENCE
        arrivals = [self.samples[at].time for at in self._arrivals() if at is not None]
        quiet = latest.time - max(arrivals, default=0.0)
        limit = _PATIENCE if len(arrivals) == len(self.uids) else self.course.seconds
        return (latest.active == 0 and ended) or quiet > limit

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
        client, count = session.first, len(session.trace)
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
            session.trace.since(count),
        )

    def _arrivals(self) -> list[int | None]:
        """Returns at which sample each waypoint was reached, after those before it."""
        found: list[int | None] = []
        departure = self._departure
        since = len(self.samples) if departure is None else departure
        for goal in self.course.waypoints:
            rest = range(since, len(self.samples))
            at = next((at for at in rest if _is_near(self.samples[at].place, goal, RADIUS)), None)
            found.append(at)
            since = since if at is None else at
        return found

    def _leg(self, number: int) -> list[Sample]:
        """Returns the samples on the way to a waypoint that was reached."""
        arrivals = self._arrivals()
        former = [at for at in arrivals[: number - 1] if at is not None]
        end = arrivals[number - 1]
        return self.samples[max(former, default=0) : None if end is None else end + 1]

    # ---- what is judged ---------------------------------------------------------------------

    def reaches(self, number: int) -> Step:
        """The target was at a waypoint, after those before it."""

        def judge(session: Session) -> None:
            x, y = self.course.waypoints[number - 1]
            at = self._arrivals()[number - 1]
            places = [each.place for each in self.samples if each.place is not None]
            session.require(bool(places), "the target did not tell where it was")
            if at is None:
                _quote(session, self.samples[-_QUOTED:], POSE.name)
                nearest = min(_distance(each, (x, y)) for each in places)
                raise CheckFailed(
                    f"not within {RADIUS} m of {x:g}, {y:g} in its turn; the nearest place of the "
                    f"drive was {nearest:.2f} m off"
                )
            session.trace.remark(f"at {x:g}, {y:g} after {self.samples[at].time:.1f} s")

        return judge

    def names_active(self, number: int) -> Step:
        """The element was told to be the active one on the way to its waypoint."""
        return self._told(number, ACTIVE, lambda each: each.active, lambda uid: uid == number)

    def tells_speed(self, number: int) -> Step:
        """The speed of ExecuteList was told on the way to a waypoint."""
        return self._told(
            number,
            SPEED,
            lambda each: each.speed,
            lambda speed: abs(speed - TRAVEL_SPEED) <= _CLOSE,
        )

    def tells_waypoint(self, number: int) -> Step:
        """A waypoint was told on the way to it."""
        goal = self.course.waypoints[number - 1]
        return self._told(
            number,
            WAYPOINT,
            lambda each: each.waypoint,
            lambda place: _is_near(place, goal, _CLOSE),
        )

    def _told(
        self,
        number: int,
        topic: Topic,
        value: Callable[[Sample], T | None],
        is_right: Callable[[T], bool],
    ) -> Step:
        def judge(session: Session) -> None:
            leg, name = self._leg(number), topic.name
            values = [found for each in leg if (found := value(each)) is not None]
            if not any(map(is_right, values)):
                _quote(session, leg, name)
            session.require(bool(values), f"Query{name} was not answered on the way to {number}")
            if not any(map(is_right, values)):
                told_values = ", ".join(dict.fromkeys(map(_words, values)))
                raise CheckFailed(
                    f"on the way to waypoint {number} Report{name} said {told_values}"
                )

        return judge


def _quote(session: Session, samples: Sequence[Sample], name: str) -> None:
    """Shows what some samples hold of a topic."""
    for each in samples[:_QUOTED]:
        session.trace.quote(line for line in each.evidence if name in line.text)


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


def _place(report: dict[str, Any]) -> Place | None:
    return (report["X"], report["Y"]) if {"X", "Y"} <= report.keys() else None


def _is_near(place: Place | None, goal: Place, radius: float) -> bool:
    return place is not None and _distance(place, goal) <= radius


def _distance(one: Place, other: Place) -> float:
    return hypot(one[0] - other[0], one[1] - other[1])


def _words(value: object) -> str:
    parts = value if isinstance(value, tuple) else (value,)
    return " ".join(f"{each:.4g}" for each in parts)
