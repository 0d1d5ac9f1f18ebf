"""How far two drives are apart that are not sampled at equal times."""

import math

import pytest
from catvehicle.metrics import Sample, position_distance

from experiments.right_turn.gather import SHIFTS, apart


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
