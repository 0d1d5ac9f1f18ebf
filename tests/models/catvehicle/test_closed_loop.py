"""The closed loop in virtual time: what JAUS alone achieves, and that delay and mismatch are seen.

Expected numbers are those of an independent simulation of the same equations; the tolerances cover
how the pose is integrated between two reports, which moves the path error by centimetres.
"""

import itertools
from dataclasses import replace

import pytest
from catvehicle import Sample, StraightArcStraight, VehicleParameters
from catvehicle.closed_loop import Loop
from catvehicle.metrics import closeness, comfort, gap, path_error

PARAMETERS = VehicleParameters()
PATH = StraightArcStraight.right_turn(PARAMETERS)


def delayed(seconds: float) -> list[Sample]:
    """Returns a run with a one-way delay in each direction."""
    return Loop(PARAMETERS, PARAMETERS, delay=seconds).run()


@pytest.fixture(scope="module")
def jaus() -> list[Sample]:
    """Returns the run without a bridge: 0.2 ms each way."""
    return delayed(0.0002)


@pytest.fixture(scope="module")
def late() -> list[Sample]:
    """Returns the run with 100 ms each way."""
    return delayed(0.1)


def test_jaus_alone_follows_the_path(jaus):
    assert path_error(jaus, PATH).maximum == pytest.approx(0.270, abs=0.03)


def test_jaus_alone_stays_in_the_safe_region(jaus):
    judged = comfort(jaus, PARAMETERS)

    assert judged.violation_fraction == 0.0
    assert judged.peak_lateral_acceleration == pytest.approx(1.95, abs=0.05)


def test_the_turn_is_to_the_right(jaus):
    turning = [sample for sample in jaus if 0.2 < -sample.psi < 1.3]

    assert len(turning) > 100
    assert all(sample.delta < 0.0 for sample in turning)
    assert all(after.psi < before.psi for before, after in itertools.pairwise(turning))
    assert all(after.y < before.y for before, after in itertools.pairwise(turning))


def test_the_vehicle_rests_at_the_end_of_the_path(jaus):
    end = jaus[-1]

    assert (end.x, end.y) == pytest.approx((37.0, -37.0), abs=0.3)
    assert end.v < 0.02
    assert end.v_cmd == 0.0


def test_the_limiter_acts_in_the_turn_and_lets_go_after_it(jaus):
    in_turn = min(sample.v for sample in jaus if 0.5 < -sample.psi < 1.2)
    after = max(sample.v for sample in jaus if sample.y < -20.0)

    assert in_turn < 4.5
    assert after > 5.3


def test_in_a_wide_turn_the_limiter_does_not_act():
    wide = replace(PARAMETERS, turn_radius=36.6)

    samples = Loop(wide, wide).run()

    assert min(sample.v for sample in samples if 0.2 < -sample.psi < 1.2) > 5.9
    assert comfort(samples, wide).peak_lateral_acceleration < 1.2


@pytest.mark.parametrize(("seconds", "position", "peak"), [(0.002, 0.06, 2.0), (0.005, 0.15, 2.0)])
def test_the_delay_of_a_good_bridge_is_hardly_seen(jaus, seconds, position, peak):
    run = delayed(seconds)
    difference = gap(jaus, run)

    assert comfort(run, PARAMETERS).violation_fraction == 0.0
    assert comfort(run, PARAMETERS).peak_lateral_acceleration < peak
    assert difference.position < position
    assert difference.speed_rms < 0.05
    assert difference.steering_rms < 0.003
    assert difference.activity_ratio == pytest.approx(1.0, abs=0.05)
    assert closeness(jaus, run, tau=0.1) < 0.1


def test_a_large_delay_leaves_the_safe_region(late):
    judged = comfort(late, PARAMETERS)

    assert judged.violation_fraction == pytest.approx(0.039, abs=0.01)
    assert judged.peak_lateral_acceleration == pytest.approx(2.33, abs=0.1)
    assert judged.least_speed_margin < 0.0


def test_a_large_delay_steers_wildly_and_falls_apart_in_time(jaus, late):
    difference = gap(jaus, late)

    assert difference.activity_ratio > 1.8
    assert difference.position == pytest.approx(3.13, abs=0.5)
    assert difference.steering_rms == pytest.approx(0.0435, abs=0.005)
    assert closeness(jaus, late, tau=0.1) > 1.0


def test_a_plant_that_understeers_leaves_the_path():
    samples = Loop(replace(PARAMETERS, understeer_coefficient=0.0015), PARAMETERS).run()

    assert path_error(samples, PATH).maximum > 1.2


def test_without_its_margin_the_limiter_does_not_suffice():
    eager = replace(PARAMETERS, comfort_margin=1.0)

    judged = comfort(Loop(eager, eager).run(), PARAMETERS)

    assert judged.violation_fraction > 0.05
    assert judged.peak_lateral_acceleration == pytest.approx(2.37, abs=0.05)


@pytest.mark.parametrize("longer", [0.06, 0.12, 0.18])
def test_where_the_reports_fall_in_the_turn_does_not_matter(longer):
    # A period is 0.24 m at 6 m/s, so a longer straight shifts the reports within the turn.
    shifted = replace(PARAMETERS, straight_length=PARAMETERS.straight_length + longer)

    judged = comfort(Loop(shifted, shifted).run(), shifted)

    assert judged.violation_fraction == 0.0
    assert judged.peak_lateral_acceleration == pytest.approx(1.95, abs=0.05)


def test_a_run_repeats_exactly(jaus):
    assert delayed(0.0002) == jaus
