"""What a run beside the simulator left behind, and how it is judged."""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NamedTuple

from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight

RATE = 20.0
"""Events a second that the driver asks for, in models/examples/simulator/simulator.ros2jaus."""
TOLERANCE = 0.03
"""Share by which the rate of events may differ from rate x pace: what the pace is measured with. It
is a thirtieth of the difference between half the pace and the whole."""
HELD = 0.05
"""Share by which the pace of a simulation that was held may differ from the one that was set."""
EDGES = 2
"""Events that a segment may have more or less besides: one that came late or early at each end."""
PATH_TOLERANCE = 0.10
"""Metres by which the largest path error may differ between paces: a period of the events, 50 ms at
6 m/s, is 0.3 m of the way, and moves the car sideways by less than a third of it."""
SETTLING = 0.5
"""Seconds of real time after which the rate counts: connections are made before."""


class Arrival(NamedTuple):
    """An event that came to the driver.

    Attributes:
        received: When, s of real time.
        stamp: The time of the simulation that it tells, s.
    """

    received: float
    stamp: float


class State(NamedTuple):
    """A step of the simulation.

    Attributes:
        real: When it was made, s of real time.
        time: Its time in the simulation, s.
        factor: The factor that was set.
        x: Position forward of the start, m.
        y: Position left of the start, m.
        v: Speed, m/s.
    """

    real: float
    time: float
    factor: float
    x: float
    y: float
    v: float


class Change(NamedTuple):
    """A factor and when it was set, s of real time."""

    real: float
    factor: float


@dataclass(frozen=True)
class Segment:
    """A time of a run in which the factor stayed what it was.

    Attributes:
        begin: Its begin, s of real time.
        end: Its end, s of real time.
        factor: The factor that was set.
        pace: Seconds of the simulation in each real one, as measured.
        real_rate: Events in a second of real time.
        simulated_rate: Events in a second of the simulation; None while it rests.
    """

    begin: float
    end: float
    factor: float
    pace: float
    real_rate: float
    simulated_rate: float | None


@dataclass(frozen=True)
class Result:
    """A run and its numbers.

    Attributes:
        name: Name of the run, and of its folder.
        follows_clock: Whether the bridge was started with use_sim_time.
        segments: Times with one factor each.
        arrived: Whether the car came to rest at the end of its path.
        path_error: Largest distance from the path, m; None for a car that has not arrived.
        duration: Seconds of the simulation until the car had arrived; None likewise.
        follows: Whether the events kept the pace of the simulation in all segments.
    """

    name: str
    follows_clock: bool
    segments: list[Segment]
    arrived: bool
    path_error: float | None
    duration: float | None
    follows: bool

    @property
    def held_pace(self) -> bool:
        """Whether the machine was fast enough for the pace that was set."""
        return all(
            abs(segment.pace - segment.factor) <= HELD * segment.factor for segment in self.segments
        )

    def write(self, folder: Path) -> None:
        """Writes the numbers to `result.json`."""
        text = json.dumps(asdict(self), indent=2, sort_keys=True, allow_nan=False)
        (folder / "result.json").write_text(text + "\n", encoding="utf-8")

    @classmethod
    def read(cls, folder: Path) -> Result:
        """Reads what `write` has written."""
        about = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        segments = [Segment(**segment) for segment in about.pop("segments")]
        return cls(**about, segments=segments)


def arrivals(folder: Path) -> list[Arrival]:
    """Returns the poses that came to the driver."""
    rows = _rows(folder / "driver.csv")
    return [
        Arrival(float(row["received_s"]), float(row["stamp_ms"]) / 1000)
        for row in rows
        if row["event"] == "pose" and row["stamp_ms"]
    ]


def states(folder: Path) -> list[State]:
    """Returns the steps of the simulation."""
    names = ("real_s", "time_s", "factor", "x_m", "y_m", "v_m_s")
    return [State(*(float(row[name]) for name in names)) for row in _rows(folder / "simulator.csv")]


def changes(folder: Path) -> list[Change]:
    """Returns the factors that were set while the run lasted."""
    path = folder / "factors.csv"
    if not path.exists():
        return []
    return [Change(float(row["real_s"]), float(row["factor"])) for row in _rows(path)]


def judge(folder: Path, name: str, *, follows_clock: bool, arrived: bool) -> Result:
    """Works out the numbers of a run from its files.

    Raises:
        ValueError: No event came.
    """
    events, steps = arrivals(folder), states(folder)
    if len(events) < 2:
        raise ValueError(f"no events came in {folder}")
    segments = _segments(events, steps, changes(folder))
    error = duration = None
    if arrived:
        path = StraightArcStraight.right_turn(VehicleParameters())
        error = max(abs(path.nearest(step.x, step.y).cross_track_error) for step in steps)
        moving = [step.time for step in steps if step.v > 0.01]
        duration = moving[-1] - moving[0]
    return Result(
        name, follows_clock, segments, arrived, error, duration, all(map(_follows, segments))
    )


def _segments(events: list[Arrival], steps: list[State], changed: list[Change]) -> list[Segment]:
    begin, end = events[0].received + SETTLING, events[-1].received
    inside = [change for change in changed if begin < change.real < end]
    bounds = [begin, *(change.real for change in inside), end]
    factors = [steps[0].factor, *(change.factor for change in inside)]
    return [
        _segment(events, steps, bounds[at], bounds[at + 1], factor)
        for at, factor in enumerate(factors)
    ]


def _segment(
    events: list[Arrival], steps: list[State], begin: float, end: float, factor: float
) -> Segment:
    times = [step.time for step in steps if begin <= step.real < end]
    pace = (times[-1] - times[0]) / (end - begin) if times else 0.0
    within = [event for event in events if begin <= event.received < end]
    if len(within) < 3:
        return Segment(begin, end, factor, pace, len(within) / (end - begin), None)
    count = len(within) - 1
    real = within[-1].received - within[0].received
    simulated = within[-1].stamp - within[0].stamp
    return Segment(begin, end, factor, pace, count / real, count / simulated)


def _follows(segment: Segment) -> bool:
    if segment.factor == 0.0:
        # One was on its way when the simulation came to rest, and the driver, which lives in real
        # time, asks anew after each second of silence and is told the present pose.
        seconds = segment.end - segment.begin
        return segment.real_rate * seconds <= 1.0 + seconds
    expected = RATE * segment.pace
    allowed = TOLERANCE * expected + EDGES / (segment.end - segment.begin)
    return abs(segment.real_rate - expected) <= allowed


def spread(results: list[Result]) -> float | None:
    """Returns by how much the path errors of the runs differ, m; None for less than two."""
    errors = [result.path_error for result in results if result.path_error is not None]
    return max(errors) - min(errors) if len(errors) > 1 else None


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
