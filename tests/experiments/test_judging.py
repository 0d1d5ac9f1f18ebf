"""Verdicts on drives whose difference is known: simulated without middleware, with known delays."""

import random
from dataclasses import replace
from functools import cache

import pytest
from catvehicle import VehicleParameters
from catvehicle.closed_loop import Loop

from experiments.right_turn.data import Run
from experiments.right_turn.judging import TOLERATED_DELAY, Row, Verdict, judge, thresholds
from experiments.right_turn.wall import judged_control

PARAMETERS = VehicleParameters()
MILLISECOND = 0.001


@cache
def drives(delay: float, seed: int, count: int, understeer: float = 0.0) -> tuple[Run, ...]:
    """Drives whose ways take a delay (s), each a little more or less, as processes do."""
    chance = random.Random(seed)
    plant = replace(PARAMETERS, understeer_coefficient=understeer)
    return tuple(
        run(
            Loop(
                plant,
                PARAMETERS,
                delay=delay + chance.uniform(0.0, MILLISECOND),
                skew=chance.uniform(0.0, 0.04),
                phase=chance.uniform(0.0, 0.04),
            )
        )
        for _ in range(count)
    )


def run(loop: Loop, **changed: object) -> Run:
    """A run of a loop with the delays that it was given."""
    ways = {"to_controller": [loop.delay] * 3, "to_vehicle": [loop.delay] * 3}
    values = {"arrived": True, "samples": loop.run(), "latencies": ways, **changed}
    return Run("J", "0", **values)  # type: ignore[arg-type]


def rows(verdict: Verdict) -> dict[str, Row]:
    return {row.name: row for row in verdict.rows}


@pytest.mark.slow
def test_a_good_bridge_is_equivalent():
    verdict = judge(drives(0.0002, 1, 4), drives(0.002, 3, 4), PARAMETERS)

    assert verdict.passes, verdict
    assert not verdict.differs
    assert verdict.pairs == 4


@pytest.mark.slow
def test_a_delay_of_100_ms_is_shown_to_differ():
    verdict = judge(drives(0.0002, 1, 4), drives(0.1, 4, 3), PARAMETERS)

    assert not verdict.passes
    assert verdict.moves_differently
    assert verdict.pairs == 3
    found = rows(verdict)
    assert found["drives that left the safe region"].value == 3
    for name in (
        "peak lateral acceleration, m/s²",
        "steering activity, relative",
        "distance in time, excess, m",
        "tyre angle in time, RMS, excess, rad",
        "median delay that is added on both ways, s",
    ):
        assert found[name].differs, name


@pytest.mark.slow
def test_a_delay_of_20_ms_is_shown_to_differ():
    # Four times what is tolerated: the test is sharp, not only able to see the absurd.
    verdict = judge(drives(0.0002, 1, 4), drives(0.02, 5, 4), PARAMETERS)

    assert verdict.differs


@pytest.mark.slow
def test_rare_long_delays_are_shown_to_differ():
    # Two of a hundred messages wait 50 ms each way: no median tells of them.
    def with_tail(run: Run) -> Run:
        ways = {way: [series[0]] * 98 + [0.05] * 2 for way, series in run.latencies.items()}
        return replace(run, latencies=ways)

    good = drives(0.0002, 1, 4)
    verdict = judge(good, [with_tail(run) for run in good], PARAMETERS)

    found = rows(verdict)
    assert found["median delay that is added on both ways, s"].passes
    tail = found["99th percentile of the delay that is added on both ways, s"]
    assert tail.bound == 0.02, "half a report period"
    assert tail.differs
    assert not verdict.passes
    assert not verdict.moves_differently


@pytest.mark.slow
def test_a_plant_that_understeers_is_shown_to_differ():
    verdict = judge(drives(0.0002, 1, 4), drives(0.0002, 6, 3, understeer=0.0015), PARAMETERS)

    assert verdict.differs
    assert rows(verdict)["largest path error, m"].differs


def test_too_few_drives_prove_nothing():
    verdict = judge(drives(0.0002, 1, 2)[:1], drives(0.0002, 1, 2)[1:2], PARAMETERS)

    assert not verdict.passes
    assert not verdict.differs
    assert rows(verdict)["largest path error, m"].interval is None


def test_scatter_makes_a_verdict_impossible_and_not_positive():
    # Means are equal, but one drive of the second system is 40 ms late and one early.
    first = drives(0.02, 7, 2)
    second = [drives(0.0002, 1, 2)[0], drives(0.04, 8, 1)[0]]

    verdict = judge(first, second, PARAMETERS)

    assert not verdict.passes
    assert not rows(verdict)["steering activity, relative"].passes


def test_a_drive_that_did_not_arrive_fails():
    good = drives(0.0002, 1, 2)
    stuck = [replace(good[0], arrived=False), *good[1:]]

    verdict = judge(good, stuck, PARAMETERS)

    assert not verdict.passes
    assert verdict.differs
    assert not verdict.moves_differently
    assert rows(verdict)["drives that did not arrive"].value == 1


@pytest.mark.slow
def test_a_control_whose_drive_did_not_arrive_is_not_measured():
    good, late = drives(0.0002, 1, 4), drives(0.1, 4, 3)
    stuck = [*late[:2], replace(late[2], arrived=False)]

    assert judged_control("late", good, late)["differs"] is True
    assert judged_control("the same", good, drives(0.0002, 2, 3))["differs"] is False
    found = judged_control("late", good, stuck)
    assert found["differs"] is None
    assert (found["drives"], found["arrived"]) == (3, 2)


def test_a_vehicle_that_never_moved_fails():
    standing = Run("R", "0", arrived=False)

    verdict = judge(drives(0.0002, 1, 2)[:1], [standing], PARAMETERS)

    assert not verdict.passes
    assert verdict.pairs == 0


def test_no_runs_are_no_verdict():
    with pytest.raises(ValueError, match="no pair"):
        judge([], drives(0.0002, 1, 2), PARAMETERS)


def test_bounds_are_what_the_tolerated_delay_does():
    bounds = thresholds(PARAMETERS)

    # Nothing that a person in the car would feel, and more than the steps of the messages.
    assert TOLERATED_DELAY == 0.005
    assert 0.006 <= bounds["path_error_max"] < 0.1
    assert 0.005 < bounds["peak_lateral_acceleration"] < 0.05
    assert 0.01 < bounds["activity"] < 0.05
    assert 0.05 < bounds["position"] < 0.2
    assert 0.005 < bounds["speed_rms"] < 0.05
    assert 0.0005 < bounds["steering_rms"] < 0.003
    assert 0.02 < bounds["closeness"] < 0.1
