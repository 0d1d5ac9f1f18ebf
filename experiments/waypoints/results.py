"""What a drive along a list left behind, and how it is judged."""

from __future__ import annotations

import csv
import json
import math
from bisect import bisect_left
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .drives import Drive, Point

TOLERANCE = 0.20
"""Metres within which a waypoint counts as passed: the follower takes it as reached at 0.15 m, by
an odometry that is 20 ms old, in which the robot drives 0.02 m, and its command is as late."""
AGE = 0.5
"""Seconds by which a pose may be older than the word of it."""
STANDSTILL = 0.01
"""Speed in m/s below which the robot stands."""
DRIFT = 0.01
"""Metres that a robot that stands may move all the same."""


class State(NamedTuple):
    """The true state of the robot.

    Attributes:
        time: When, s.
        x: Position forward of the start, m.
        y: Position left of the start, m.
        speed: Forward speed, m/s.
    """

    time: float
    x: float
    y: float
    speed: float


class Event(NamedTuple):
    """What the operator did or was told.

    Attributes:
        kind: `execute`, `active`, `pose`, `emergency`, `lost` or `ended`.
        time: When, s.
        value: The active element, or 1 for an end that is done; 0 for others.
        x: Where the robot is said to be in JAUS axes, m; not a number for no pose.
        y: The same to the right.
    """

    kind: str
    time: float
    value: int
    x: float = math.nan
    y: float = math.nan


@dataclass(frozen=True)
class Passage:
    """How a waypoint was passed.

    Attributes:
        number: Number of its element, from 1.
        told: When the operator was told that it is active, s after the list was executed; None for
            never.
        nearest: Least distance of the robot while it was active, m; None for never active.
        nearest_time: When that was, s after the list was executed.
    """

    number: int
    told: float | None
    nearest: float | None
    nearest_time: float | None


@dataclass(frozen=True)
class Result:
    """A drive and its judgement.

    Attributes:
        name: Name of the drive and of its folder.
        waypoints: Where they are, m, in ROS axes.
        active: Active elements in the order in which the operator was told of them.
        passages: What became of each waypoint.
        done: How the end was told: done or not; None for no word of an end.
        duration: Seconds from ExecuteList until the end was told; None likewise.
        emergency: When there was one or the operator was lost, s after ExecuteList; else None.
        stop_time: Seconds from the emergency until the robot stood; None for never.
        drift: Metres that the robot moved from then on; None likewise.
        pose_error: Metres between where the robot was and was said to be, at most.
        claims: What must hold, and whether it does.
    """

    name: str
    waypoints: list[Point]
    active: list[int]
    passages: list[Passage]
    done: bool | None
    duration: float | None
    emergency: float | None
    stop_time: float | None
    drift: float | None
    pose_error: float | None
    claims: dict[str, bool]

    def write(self, folder: Path) -> None:
        """Writes it to `result.json`."""
        text = json.dumps(asdict(self), indent=2, sort_keys=True, allow_nan=False)
        (folder / "result.json").write_text(text + "\n", encoding="utf-8")

    @classmethod
    def read(cls, folder: Path) -> Result:
        """Reads what `write` has written."""
        about = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        about["passages"] = [Passage(**each) for each in about["passages"]]
        about["waypoints"] = [(x, y) for x, y in about["waypoints"]]
        return cls(**about)


def states(folder: Path) -> list[State]:
    """Returns the true states of the robot."""
    names = ("real_s", "x_m", "y_m", "v_m_s")
    return [State(*(float(row[name]) for name in names)) for row in _rows(folder / "wheels.csv")]


def events(folder: Path) -> list[Event]:
    """Returns what the operator wrote down."""
    return [
        Event(
            row["event"],
            float(row["real_s"]),
            int(row["value"] or 0),
            float(row["x_m"] or "nan"),
            float(row["y_m"] or "nan"),
        )
        for row in _rows(folder / "operator.csv")
    ]


def judge(drive: Drive, truth: Sequence[State], told: Sequence[Event]) -> Result:
    """Works out what became of a list.

    Args:
        truth: Where the robot was.
        told: What the operator did and was told, or what became of it.

    Raises:
        ValueError: The list was never executed.
    """
    name, waypoints = drive.name, drive.waypoints
    begin = _time(told, "execute")
    if begin is None:
        raise ValueError(f"the list of {name} was never executed")
    told = [each for each in told if each.time >= begin]
    active = [each for each in told if each.kind == "active"]
    last = truth[-1].time
    passages = [
        _passage(number, point, active, truth, begin, last)
        for number, point in enumerate(waypoints, 1)
    ]
    end = next((each for each in told if each.kind == "ended"), None)
    emergency = _time(told, "lost" if drive.lost_at is not None else "emergency")
    stop_time, drift = _stop(truth, emergency) if emergency is not None else (None, None)
    result = Result(
        name,
        list(waypoints),
        [each.value for each in active],
        passages,
        None if end is None else bool(end.value),
        None if end is None else end.time - begin,
        None if emergency is None else emergency - begin,
        stop_time,
        drift,
        _distance(truth, told),
        {},
    )
    return replace(result, claims=_claims(drive, result))


def _claims(drive: Drive, result: Result) -> dict[str, bool]:
    far = result.pose_error
    claims = {
        f"where the robot is said to be, it is within {TOLERANCE:g} m, or was {AGE:g} s ago": far
        is not None
        and far <= TOLERANCE
    }
    if drive.lost_at is not None:
        return claims | _claims_of_stop(drive, result, "without its operator, the robot stops")
    if drive.emergency_at is not None:
        return claims | _claims_of_emergency(drive, result)
    return claims | _claims_of_drive(result)


def _claims_of_drive(result: Result) -> dict[str, bool]:
    passed = [each.nearest is not None and each.nearest <= TOLERANCE for each in result.passages]
    return {
        f"each waypoint is passed within {TOLERANCE:g} m while it is active": all(passed),
        "the active elements are reported in order": result.active
        == [*range(1, len(result.waypoints) + 1), 0],
        "the end is reported as done": result.done is True,
    }


def _claims_of_stop(drive: Drive, result: Result, words: str) -> dict[str, bool]:
    stop, drift = result.stop_time, result.drift
    return {
        f"{words} within {drive.stops_in:g} s": stop is not None and stop <= drive.stops_in,
        "and it stays where it stopped": drift is not None and drift <= DRIFT,
    }


def _claims_of_emergency(drive: Drive, result: Result) -> dict[str, bool]:
    reached = max(result.active, default=0)
    return {
        **_claims_of_stop(drive, result, "an emergency stops the robot"),
        "the list ends before its last waypoint": 0 < reached < len(result.waypoints)
        and result.active == [*range(1, reached + 1), 0],
        "its end is reported as not done": result.done is False,
    }


def _passage(
    number: int,
    point: Point,
    active: Sequence[Event],
    truth: Sequence[State],
    begin: float,
    last: float,
) -> Passage:
    at = next((at for at, each in enumerate(active) if each.value == number), None)
    if at is None:
        return Passage(number, None, None, None)
    first = active[at].time
    until = active[at + 1].time if at + 1 < len(active) else last
    near = [
        (math.dist((each.x, each.y), point), each.time)
        for each in truth
        if first <= each.time <= until
    ]
    if not near:
        return Passage(number, first - begin, None, None)
    distance, time = min(near)
    return Passage(number, first - begin, distance, time - begin)


def _stop(truth: Sequence[State], emergency: float) -> tuple[float | None, float | None]:
    """Returns how long the robot took to stand for good, and how far it moved from then on."""
    after = [each for each in truth if each.time >= emergency]
    moving = [at for at, each in enumerate(after) if abs(each.speed) >= STANDSTILL]
    first = moving[-1] + 1 if moving else 0
    if first >= len(after):
        return None, None
    stood = after[first]
    drift = math.dist((stood.x, stood.y), (after[-1].x, after[-1].y))
    return stood.time - emergency, drift


def _distance(truth: Sequence[State], told: Sequence[Event]) -> float | None:
    """Returns how far the robot was at most from where it was said to be; None for no word.

    Of what it did in the last moments, the nearest counts.
    """
    times = [each.time for each in truth]
    apart = []
    for each in told:
        if each.kind == "pose" and truth:
            last = bisect_left(times, each.time) + 1
            first = min(bisect_left(times, each.time - AGE), len(truth) - 1)
            near = (math.dist((at.x, -at.y), (each.x, each.y)) for at in truth[first:last])
            apart.append(min(near))
    return max(apart, default=None)


def _time(told: Sequence[Event], kind: str) -> float | None:
    """Returns when something happened last; a list may be executed again until it is followed."""
    times = [each.time for each in told if each.kind == kind]
    return times[-1] if times else None


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
