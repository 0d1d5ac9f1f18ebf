"""Drive along waypoints, judged by reports of the target, and steps with messages by names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import hypot
from typing import Any, TypeAlias, TypeVar

from jausml.live.messages import MessageError
from jausml.live.messages.codec import PRESENCE
from jausml.live.peers.conformance.check import Step, step
from jausml.live.peers.conformance.client import Client
from jausml.live.peers.conformance.evidence import CheckFailed, TraceLine
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import Judgement, ask
from jausml.live.peers.entry_messages import EntryMessage, message_class
from jausml.runtime.messages import SetElement
from jausml.runtime.services.list_manager import chain

PRESENCE_VECTOR = "PresenceVector"
_DAY = 86400.0


@dataclass(frozen=True, slots=True)
class Topic:
    """A query and its report of a service: QueryNAME and ReportNAME.

    Attributes:
        presence: Presence vector of the query; None when it has none.
    """

    service: str
    name: str
    presence: int | None = None

    def query(self, session: Session) -> EntryMessage:
        """Returns the query."""
        fields: dict[str, Any] = {}
        if self.presence is not None:
            fields = {PRESENCE_VECTOR: self.presence}
        return message_of(session, self.service, f"Query{self.name}", **fields)

    def report(self, session: Session) -> type[EntryMessage]:
        """Returns the class of the report."""
        return message_class(session.catalogue.message(f"Report{self.name}", self.service))


def message_of(session: Session, service: str, name: str, **fields: Any) -> EntryMessage:
    """Returns a message of a service; `fields` may leave out the record of its body."""
    entry = session.catalogue.message(name, service)
    return message_class(entry)(entry.completed(fields) if fields else {})


def fields_of(message: EntryMessage) -> dict[str, Any]:
    """Returns the present fields of a message with one record."""
    (record,) = message.fields.values()
    return {name: value for name, value in record.items() if name != PRESENCE}


def asks(client: int, topic: Topic, *judgements: Judgement[EntryMessage]) -> Step:
    """A client asks for something, and the report is as it should be."""

    def run(session: Session) -> None:
        ask(client, topic.query, topic.report(session), *judgements)(session)

    return run


def holds(*names: str) -> Judgement[EntryMessage]:
    """Fails unless a report has these fields."""

    def judge(_: Session, message: EntryMessage, what: str) -> None:
        lacking = [name for name in names if name not in fields_of(message)]
        if lacking:
            raise CheckFailed(f"{what} lacks {', '.join(lacking)}")

    return judge


@step
def goes_on(session: Session, client: int, topic: Topic, seconds: float, fastest: float) -> None:
    """Time stamps of two reports differ by about the time between them, and no position jumps.

    Args:
        fastest: Metres per second that are not believed.
    """
    before, then = _report(session, client, topic), session.probe.now()
    session.probe.wait(lambda: False, seconds)
    after = _report(session, client, topic)
    elapsed = session.probe.now() - then
    passed = (_seconds(after) - _seconds(before)) % _DAY
    if not 0 < passed <= 2 * elapsed:
        raise CheckFailed(
            f"the time stamps of two reports {elapsed:.1f} s apart differ by {passed:.3f} s"
        )
    if {"X", "Y"} <= after.keys() & before.keys():
        speed = hypot(after["X"] - before["X"], after["Y"] - before["Y"]) / passed
        session.require(speed < fastest, f"the position changes by {speed:.1f} m/s")


def _report(session: Session, client: int, topic: Topic) -> dict[str, Any]:
    report = session.client(client).ask(topic.query(session), topic.report(session))
    holds("TimeStamp")(session, report, report.NAME)
    return fields_of(report)


def _seconds(report: dict[str, Any]) -> float:
    stamp = report["TimeStamp"]
    hours = 60 * (60 * stamp["Hour"] + stamp["Minutes"]) + stamp["Seconds"]
    return float(hours + stamp["Milliseconds"] / 1000)


T = TypeVar("T")
Place: TypeAlias = tuple[float, float]  # x and y in metres

DRIVER = "LocalWaypointListDriver"
ACTIVE = Topic(DRIVER, "ActiveElement")
SPEED = Topic(DRIVER, "TravelSpeed")
WAYPOINT = Topic(DRIVER, "LocalWaypoint", presence=0)
POSE = Topic("LocalPoseSensor", "LocalPose", presence=3)

RADIUS = 0.5  # metres within which a waypoint counts as reached; the published rules name none

TRAVEL_SPEED = 1.0  # speed in m/s of ExecuteList, as the rules have it

_PERIOD = 0.2
_PATIENCE = 3.0
_CLOSE = 0.01
_QUOTED = 3


@dataclass(frozen=True)
class Course:
    """The waypoints of a drive.

    Attributes:
        waypoints: x and y in metres, in the local frame of the target: x forward, y right.
        seconds: Greatest time from one to the next.
    """

    waypoints: tuple[Place, ...] = ((2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0))
    seconds: float = 60.0


@dataclass(frozen=True)
class Sample:
    """The reports of the target at a time; None for a missing one.

    Attributes:
        time: Seconds since ExecuteList.
        active: UID of the active element.
        speed: Reported travel speed in m/s.
        evidence: The sent and received messages.
    """

    time: float
    active: int | None = None
    place: Place | None = None
    speed: float | None = None
    waypoint: Place | None = None
    evidence: tuple[TraceLine, ...] = ()


@dataclass
class Drive:
    """A drive along a course; its steps judge its samples."""

    course: Course
    samples: list[Sample] = field(default_factory=list)

    def list_of(self, session: Session) -> SetElement:
        """Returns the request that sets the waypoints, under the UIDs 1, 2, and so on."""
        contents = [
            (uid, message_of(session, DRIVER, "SetLocalWaypoint", X=x, Y=y).encode(), 0)
            for uid, (x, y) in enumerate(self.course.waypoints, 1)
        ]
        records = [
            SetElement.ElementRec(
                content.uid,
                content.previous_uid,
                content.next_uid,
                SetElement.ElementData(content.data_format, content.data),
            )
            for content in chain(contents)
        ]
        return SetElement(SetElement.RequestIDRec(1), records)

    @property
    def uids(self) -> tuple[int, ...]:
        """The UIDs of the elements."""
        return tuple(range(1, len(self.course.waypoints) + 1))

    def execute(self, session: Session) -> None:
        """Starts the execution of the list, and asks repeatedly until it ends or time is over."""
        execute = message_of(session, DRIVER, "ExecuteList", Speed=TRAVEL_SPEED, ElementUID=1)
        session.send(0, execute)
        begun = session.probe.now()
        self.samples.clear()
        while not self._is_over():
            self.samples.append(self._sample(session, begun))
        session.require(
            self._departure is not None or any(sample.active for sample in self.samples),
            "the list is not executed: no element is active, and nothing moves",
        )

    def _is_over(self) -> bool:
        """Returns whether the list has ended, or the next waypoint or the end takes too long."""
        if not self.samples:
            return False
        latest = self.samples[-1]
        ended = any(sample.active for sample in self.samples) or latest.time > _PATIENCE
        arrivals = [self.samples[at].time for at in self._arrivals() if at is not None]
        quiet = latest.time - max(arrivals, default=0.0)
        limit = _PATIENCE if len(arrivals) == len(self.uids) else self.course.seconds
        return (latest.active == 0 and ended) or quiet > limit

    @property
    def _departure(self) -> int | None:
        """The index of the first sample away from the start."""
        start = next((sample.place for sample in self.samples if sample.place is not None), None)
        away = (
            at
            for at, sample in enumerate(self.samples)
            if start and sample.place and _distance(sample.place, start) > RADIUS
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
        """Returns the index of the first sample at each waypoint in order, None if not reached."""
        arrivals: list[int | None] = []
        departure = self._departure
        since = len(self.samples) if departure is None else departure
        for goal in self.course.waypoints:
            rest = range(since, len(self.samples))
            at = next((at for at in rest if _is_near(self.samples[at].place, goal, RADIUS)), None)
            arrivals.append(at)
            since = since if at is None else at
        return arrivals

    def _leg(self, number: int) -> list[Sample]:
        """Returns the samples on the way to a waypoint that was reached."""
        arrivals = self._arrivals()
        former = [at for at in arrivals[: number - 1] if at is not None]
        end = arrivals[number - 1]
        return self.samples[max(former, default=0) : None if end is None else end + 1]

    # ---- steps ------------------------------------------------------------------------------

    def reaches(self, number: int) -> Step:
        """The target was at a waypoint, after those before it."""

        def judge(session: Session) -> None:
            x, y = self.course.waypoints[number - 1]
            at = self._arrivals()[number - 1]
            places = [sample.place for sample in self.samples if sample.place is not None]
            session.require(bool(places), "the target did not tell where it was")
            if at is None:
                _quote(session, self.samples[-_QUOTED:], POSE.name)
                nearest = min(_distance(place, (x, y)) for place in places)
                raise CheckFailed(
                    f"not within {RADIUS} m of {x:g}, {y:g} in its turn; the nearest place of the "
                    f"drive was {nearest:.2f} m off"
                )
            session.trace.remark(f"at {x:g}, {y:g} after {self.samples[at].time:.1f} s")

        return judge

    def names_active(self, number: int) -> Step:
        """The element was told to be the active one on the way to its waypoint."""
        return self._reported(
            number, ACTIVE, lambda sample: sample.active, lambda uid: uid == number
        )

    def tells_speed(self, number: int) -> Step:
        """The speed of ExecuteList was told on the way to a waypoint."""
        return self._reported(
            number,
            SPEED,
            lambda sample: sample.speed,
            lambda speed: abs(speed - TRAVEL_SPEED) <= _CLOSE,
        )

    def tells_waypoint(self, number: int) -> Step:
        """A waypoint was told on the way to it."""
        goal = self.course.waypoints[number - 1]
        return self._reported(
            number,
            WAYPOINT,
            lambda sample: sample.waypoint,
            lambda place: _is_near(place, goal, _CLOSE),
        )

    def _reported(
        self,
        number: int,
        topic: Topic,
        value: Callable[[Sample], T | None],
        is_right: Callable[[T], bool],
    ) -> Step:
        def judge(session: Session) -> None:
            leg, name = self._leg(number), topic.name
            values = [sample_value for sample in leg if (sample_value := value(sample)) is not None]
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
    """Adds messages of a topic in some samples to the trace."""
    for sample in samples[:_QUOTED]:
        session.trace.quote(line for line in sample.evidence if name in line.text)


def _latest(session: Session, client: Client, topic: Topic) -> dict[str, Any]:
    """Returns the fields of the last report of a topic; empty if none came, or it is malformed."""
    kind = topic.report(session)
    for received in reversed(client.inbox):
        if received.code == kind.CODE:
            try:
                return fields_of(kind(kind.ENTRY.decode(received.payload)))
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
    return " ".join(f"{part:.4g}" for part in parts)
