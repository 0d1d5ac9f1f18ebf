"""Judges whether drives of two systems are equivalent, by tests that can fail.

**What must be equal.** Drives are paired as they were made. For each pair stand differences of
numbers that judge one drive (path error, peak lateral acceleration, steering activity) and of how
far the two are apart at equal times since the first motion (position, speed, tyre angle, and the
smallest eps of (0.1 s, eps)-closeness, the conformance of hybrid systems).

**By how much they may differ.** All bounds follow from one choice, `TOLERATED_DELAY`: a bridge may
make each way 5 ms longer. That is an eighth of the report period (40 ms), which a change of the
vehicle's state waits for anyway, and there and back a twenty-fifth of its fastest time constant
(steering, 0.25 s). `thresholds` works out what this delay does to the same plant, laws and codec
without any middleware (`catvehicle.closed_loop`), at the worst of four phases of the two reports:
speed and tyre angle come by events, and have the phase of the messages that created them. Floors
are what no experiment can tell apart:

- where the reports fall on the path: the vehicle moves v_ref T = 0.24 m between two, and nobody
  synchronises its clock with the path. The largest effect of a quarter, half and three quarters of
  that counts for numbers of single drives;
- the quanta of the codec: time stamps name milliseconds, so that nobody knows better than
  v_ref 1 ms = 6 mm where the vehicle was; the effort field has 200 % / 65535, 1.6e-5 rad of tyre
  angle, whose sum over the steps of a drive counts for steering activity;
- path errors of two drives cannot differ more than the drives are apart in space, so that their
  bound is that of closeness. Delay hardly changes them: they are no sharp measure of a bridge.

**Delay.** The median of the delay that is added may be the tolerated one, twice. One message in a
hundred may be late by half a report period (20 ms, both ways): then its answer still comes before
that to the next report, and the order of the loop is kept.

**J against J.** Even J differs from J: the reports of one drive fall elsewhere, and processes are
scheduled as it happens. Distances in time are never negative, so they would count this noise as a
difference. Judged is their excess: the distance of the pair less that of the first drive to the
first drive of the next pair. (An excess shares a drive with the next one; its scatter is a little
under-estimated.)

**The test.** Two one-sided t tests (TOST, Schuirmann 1987) at 5 % each: systems are equivalent in a
number when the whole 90 % confidence interval of the mean difference lies within the bound.
Equivalent they are in all numbers or not at all (an intersection-union test: the chance to call
different systems equivalent stays below 5 % without a correction). "No significant difference"
would be passed by too few drives; here too few drives fail. A system is shown *different*
when an interval lies wholly outside its bound: that is what positive controls must reach.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from statistics import fmean
from typing import NamedTuple

from catvehicle.closed_loop import EFFORT_QUANTUM, Loop
from catvehicle.metrics import Sample, closeness, gap
from catvehicle.parameters import VehicleParameters

from experiments.right_turn.data import Run
from experiments.right_turn.drives import from_first_motion, judged
from experiments.right_turn.student import mean_interval

TOLERATED_DELAY = 0.005
"""Seconds that a bridge may add on each way."""

CONFIDENCE = 0.95
"""Confidence of each of the two one-sided tests."""

SHIFT = 0.1
"""Seconds by which states may be apart in time in the notion of closeness."""

LEAST_DELAY = 0.0002
"""Seconds of each way without a bridge, in the loop that bounds are derived from."""

STAMP_QUANTUM = 0.001
"""Seconds that a time stamp of a report can tell apart."""

REST = 0.02
"""A part of the vehicle's last metre that is left to drive takes long and moves it little: what
happens within this speed (m/s) of standstill is not compared."""


class Measure(NamedTuple):
    """A number that is judged.

    Attributes:
        key: Its name in `differences`.
        words: Its name in tables, with its unit.
        is_excess: Whether it is how much farther apart than J from J, where less is as good.
    """

    key: str
    words: str
    is_excess: bool


MEASURES = (
    Measure("path_error_max", "largest path error, m", is_excess=False),
    Measure("peak_lateral_acceleration", "peak lateral acceleration, m/s²", is_excess=False),
    Measure("activity", "steering activity, relative", is_excess=False),
    Measure("position", "distance in time, excess, m", is_excess=True),
    Measure("speed_rms", "speed in time, RMS, excess, m/s", is_excess=True),
    Measure("steering_rms", "tyre angle in time, RMS, excess, rad", is_excess=True),
    Measure("closeness", "eps of (0.1 s, eps)-closeness, excess, m", is_excess=True),
)


MEDIAN, RARE = 0.5, 0.99

DELAYS = {
    MEDIAN: Measure("delay", "median delay that is added on both ways, s", is_excess=True),
    RARE: Measure(
        "rare_delay", "99th percentile of the delay that is added on both ways, s", is_excess=True
    ),
}
"""Measures of the delay, by the share of the messages that are faster."""


@dataclass(frozen=True)
class Row:
    """The verdict on one number.

    Attributes:
        name: What it is, with its unit.
        value: Mean of the differences, or a count.
        interval: Its confidence interval; None for a count and for fewer than two pairs.
        bound: Largest size of a difference that does not matter.
        passes: Whether it is shown that the difference does not matter.
        differs: Whether it is shown that it does.
    """

    name: str
    value: float
    interval: tuple[float, float] | None
    bound: float
    passes: bool
    differs: bool


@dataclass(frozen=True)
class Verdict:
    """The verdict on two systems.

    Attributes:
        rows: Those on the numbers.
        pairs: Pairs of drives that it stands on.
    """

    rows: tuple[Row, ...]
    pairs: int

    @property
    def passes(self) -> bool:
        """Whether the systems are shown to be equivalent."""
        return all(row.passes for row in self.rows)

    @property
    def differs(self) -> bool:
        """Whether they are shown to be different; with too few drives they are neither."""
        return any(row.differs for row in self.rows)

    @property
    def moves_differently(self) -> bool:
        """Whether that is shown by the motion: neither by drives that failed nor by delays."""
        motion = {measure.words for measure in MEASURES}
        return any(row.differs and row.name in motion for row in self.rows)


def judge(
    first_runs: Sequence[Run], second_runs: Sequence[Run], parameters: VehicleParameters
) -> Verdict:
    """Judges whether the second system may stand in for the first.

    Args:
        first_runs: Runs of the system that is known to be good.
        second_runs: As many runs of the other one; what one has more is left out.
        parameters: Of vehicle, laws and scenario.

    Raises:
        ValueError: There is no pair of runs.
    """
    pairs = [(one, two) for one, two in zip(first_runs, second_runs, strict=False)]
    if not pairs:
        raise ValueError("there is no pair of runs to judge")
    seconds = [two for _, two in pairs]
    rows = [
        _count("drives that did not arrive", sum(not run.arrived for run in seconds)),
        _count("drives that left the safe region", sum(map(_is_unsafe, seconds))),
    ]
    driven = [(_drive(one), _drive(two)) for one, two in pairs]
    driven = [(one, two) for one, two in driven if one and two]
    if driven:
        bounds = thresholds(parameters)
        deviations = differences(driven)
        rows += [
            _tested(quantity, deviations[quantity.key], bounds[quantity.key])
            for quantity in MEASURES
        ]
    for share, measure in DELAYS.items():
        delays = [_added_delay(pair, share) for pair in pairs]
        found_delays = [added for added in delays if added is not None]
        if found_delays:
            rows.append(_tested(measure, found_delays, _longest_delay(share, parameters)))
    return Verdict(tuple(rows), len(driven))


def differences(
    drives: Sequence[tuple[Sequence[Sample], Sequence[Sample]]],
) -> dict[str, list[float]]:
    """Returns the difference of each pair of drives, the second less the first, by measure.

    Args:
        drives: Pairs, with times from the first motion.
    """
    alone = [(judged(one), judged(two)) for one, two in drives]
    deviations = {
        key: [two[key] - one[key] for one, two in alone]
        for key in ("path_error_max", "peak_lateral_acceleration")
    }
    deviations["activity"] = [
        two["steering_activity"] / one["steering_activity"] - 1.0 for one, two in alone
    ]
    apart = [_distances(one, two) for one, two in drives]
    firsts = [one for one, _ in drives]
    floors = [_distances(one, other) for one, other in pairwise([*firsts, firsts[0]])]
    for key in ("position", "speed_rms", "steering_rms", "closeness"):
        # With one pair there is no other first drive, and its floor is 0.
        deviations[key] = [one[key] - floor[key] for one, floor in zip(apart, floors, strict=True)]
    return deviations


@lru_cache
def thresholds(parameters: VehicleParameters) -> Mapping[str, float]:
    """Returns the bound of each measure, as the description of this module derives it."""
    reference, period = _loop(parameters), 1.0 / parameters.report_rate
    pairs = [
        (reference, _loop(parameters, LEAST_DELAY + TOLERATED_DELAY, part * period))
        for part in (0.0, 0.25, 0.5, 0.75)
    ]
    deviations = [differences([pair]) for pair in pairs]
    bounds = {
        key: max(abs(difference[key][0]) for difference in deviations) for key in deviations[0]
    }
    alone = judged(reference, parameters)
    for part in (0.25, 0.5, 0.75):
        straight = parameters.straight_length + part * period * parameters.reference_speed
        moved = replace(parameters, straight_length=straight)
        peak = judged(_loop(moved), moved)["peak_lateral_acceleration"]
        bounds["peak_lateral_acceleration"] = max(
            bounds["peak_lateral_acceleration"], abs(peak - alone["peak_lateral_acceleration"])
        )
    placed = STAMP_QUANTUM * parameters.reference_speed
    bounds |= {key: max(bounds[key], placed) for key in ("position", "closeness")}
    bounds["path_error_max"] = bounds["closeness"]
    summed = EFFORT_QUANTUM / 100 * parameters.steering_limit * alone["duration"] / period
    bounds["activity"] = max(bounds["activity"], summed / alone["steering_activity"])
    return bounds


def _loop(
    parameters: VehicleParameters, delay: float = LEAST_DELAY, skew: float = 0.0
) -> list[Sample]:
    return _trimmed(from_first_motion(Loop(parameters, parameters, delay, skew).run()))


def _drive(run: Run) -> list[Sample]:
    return _trimmed(from_first_motion(run.samples))


def _trimmed(drive: Sequence[Sample]) -> list[Sample]:
    moving = [sample.t for sample in drive if sample.v > REST]
    return [sample for sample in drive if sample.t <= moving[-1]] if moving else []


def _distances(one: Sequence[Sample], two: Sequence[Sample]) -> dict[str, float]:
    if one is two:
        return dict.fromkeys(("position", "speed_rms", "steering_rms", "closeness"), 0.0)
    difference = gap(one, two)
    end = min(one[-1].t, two[-1].t)
    common = [[sample for sample in drive if sample.t <= end] for drive in (one, two)]
    return {
        "position": difference.position,
        "speed_rms": difference.speed_rms,
        "steering_rms": difference.steering_rms,
        "closeness": closeness(*common, SHIFT),
    }


def _is_unsafe(run: Run) -> bool:
    return judged(from_first_motion(run.samples)).get("violation_fraction", math.inf) > 0.0


def _added_delay(pair: tuple[Run, Run], share: float) -> float | None:
    """Returns what is added to a quantile of the delay, both ways, s; None if not measured."""
    hops = ("to_controller", "to_vehicle")
    if not all(run.latencies.get(way) for run in pair for way in hops):
        return None
    one, two = (sum(_quantile(run.latencies[way], share) for way in hops) for run in pair)
    return two - one


def _quantile(values: Sequence[float], share: float) -> float:
    return sorted(values)[math.ceil(share * len(values)) - 1]


def _longest_delay(share: float, parameters: VehicleParameters) -> float:
    """Returns the bound of a quantile of the delay that is added, both ways, s."""
    return 2 * TOLERATED_DELAY if share == MEDIAN else 0.5 / parameters.report_rate


def _count(name: str, number: int) -> Row:
    return Row(name, number, None, 0.0, passes=number == 0, differs=number > 0)


def _tested(measure: Measure, values: Sequence[float], bound: float) -> Row:
    interval = mean_interval(values, CONFIDENCE)
    passes = differs = False
    if interval is not None:
        low, high = interval
        passes = high <= bound and (measure.is_excess or low >= -bound)
        differs = low > bound or (high < -bound and not measure.is_excess)
    return Row(measure.words, fmean(values), interval, bound, passes=passes, differs=differs)
