"""How far two drives are apart that are not sampled at equal times."""

import math

import pytest
from catvehicle.metrics import Sample, position_distance

from experiments.right_turn.gather import SHIFTS, apart
from experiments.right_turn.student import mean_interval, student_cdf, student_quantile


def drive(first, count, ahead=0.0):
    """Returns a drive at 2 m/s along x, sampled ten times a second."""
    times = [first + 0.1 * number for number in range(count)]
    return [Sample(t, 2.0 * (t + ahead), 0.0, 0.0, 2.0, 0.0, 0.0, 2.0) for t in times]


@pytest.mark.parametrize("shift", SHIFTS)
def test_drives_of_other_lengths_and_times_are_finitely_apart(shift):
    found = apart(drive(0.0, 20), drive(0.03, 25), shift, position_distance)
    assert math.isfinite(found)


def test_without_a_shift_states_are_compared_at_equal_times():
    one, two = drive(0.0, 20), drive(0.03, 20, ahead=0.05)
    assert apart(one, two, 0.0, position_distance) == pytest.approx(0.1)


def test_a_shift_finds_the_state_that_comes_later():
    def resting_at_both_ends(late):
        times = [round(0.1 * number, 1) for number in range(20)]
        places = [min(max(t - 0.5 - late, 0.0), 1.0) for t in times]
        return [
            Sample(t, x, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0) for t, x in zip(times, places, strict=True)
        ]

    one, two = resting_at_both_ends(0.0), resting_at_both_ends(0.1)
    assert apart(one, two, 0.0, position_distance) == pytest.approx(0.1)
    assert apart(one, two, 0.1001, position_distance) == pytest.approx(0.0, abs=1e-9)


# -- Student's t distribution against tables -------------------------------------------------------


@pytest.mark.parametrize(
    ("share", "freedom", "value"),
    [
        # NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2.
        (0.95, 1, 6.314),
        (0.95, 2, 2.920),
        (0.95, 9, 1.833),
        (0.95, 19, 1.729),
        (0.975, 9, 2.262),
        (0.99, 5, 3.365),
        (0.95, 100, 1.660),
    ],
)
def test_quantiles(share, freedom, value):
    assert student_quantile(share, freedom) == pytest.approx(value, abs=5e-4)


def test_the_distribution_is_symmetric_and_whole():
    assert student_cdf(0.0, 7) == 0.5
    assert student_cdf(1.3, 7) + student_cdf(-1.3, 7) == pytest.approx(1.0)
    assert student_cdf(1e6, 2) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("share", "freedom"), [(0.5, 3), (1.0, 3), (0.95, 0)])
def test_what_has_no_quantile_is_refused(share, freedom):
    with pytest.raises(ValueError, match="no quantile"):
        student_quantile(share, freedom)


def test_interval_of_a_mean():
    # Mean 2, standard deviation 1: 2.920 / sqrt(3) on either side.
    assert mean_interval([1.0, 2.0, 3.0], 0.95) == pytest.approx((0.314, 3.686), abs=1e-3)
    assert mean_interval([2.0, 2.0], 0.95) == (2.0, 2.0)
    assert mean_interval([2.0], 0.95) is None
