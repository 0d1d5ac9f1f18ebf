"""Drives are cut and judged from their first motion on."""

import pytest
from catvehicle.metrics import Sample

from experiments.right_turn.drives import from_first_motion, is_at_end, judged


def sample(t: float, x: float, v: float) -> Sample:
    return Sample(t=t, x=x, y=0.0, psi=0.0, v=v, delta=0.0, delta_cmd=0.0, v_cmd=v)


def test_times_count_from_where_the_speed_crosses_the_threshold():
    standing = [sample(0.01 * index, 0.0, 0.0) for index in range(500)]
    # 2 m/s^2 from rest: 0.02 m/s after 10 ms, which is between two samples here.
    moving = [sample(5.005 + 0.01 * index, 0.0, 0.01 + 0.02 * index) for index in range(10)]

    cut = from_first_motion(standing + moving)

    assert len(cut) == 10
    assert cut[0].t == pytest.approx(-0.005)
    assert cut[1].t == pytest.approx(0.005)
    assert cut[1].v == moving[1].v


def test_a_drive_without_motion_is_empty_and_has_no_numbers():
    cut = from_first_motion([sample(0.01 * index, 0.0, 0.0) for index in range(5)])

    assert cut == []
    assert judged(cut) == {}


def test_standing_at_the_end_is_no_part_of_the_drive():
    drive = [sample(0.1 * index, 0.4 * index, 4.0) for index in range(11)]
    rest = [sample(1.1 + index, 4.0, 0.0) for index in range(100)]

    assert judged(drive + rest)["duration"] == pytest.approx(1.0)
    assert judged(drive + rest) == judged(drive)


@pytest.mark.parametrize(
    ("x", "y", "v", "arrived"),
    [(37.0, -36.8, 0.1, True), (37.0, -36.8, 1.0, False), (30.0, -5.0, 0.0, False)],
)
def test_arrived_is_who_stands_at_the_end(x, y, v, arrived):
    state = Sample(t=20.0, x=x, y=y, psi=-1.57, v=v, delta=0.0, delta_cmd=0.0, v_cmd=0.0)

    assert is_at_end(state) is arrived
