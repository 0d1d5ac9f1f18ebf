"""Metrics on runs whose answer is known, logs, and the text table."""

import math
from dataclasses import replace

import pytest
from catvehicle import (
    LogWriter,
    Sample,
    StraightArcStraight,
    Table,
    VehicleParameters,
    read_log,
    write_log,
)
from catvehicle.metrics import closeness, comfort, gap, latency_summary, path_error, total_variation
from hypothesis import given
from hypothesis import strategies as st

PARAMETERS = VehicleParameters()
PATH = StraightArcStraight.right_turn(PARAMETERS)
HEADER = "t,x,y,psi,v,delta,delta_cmd,v_cmd\n"
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


def straight_run(speed: float = 2.0, y: float = 0.0, late: float = 0.0) -> list[Sample]:
    """Returns a run along the x axis: metres per second, metres to the left, seconds late."""
    times = [0.1 * index for index in range(101)]
    return [Sample(t, speed * (t - late), y, 0.0, speed, 0.0, 0.0, speed) for t in times]


def test_path_error_takes_either_side():
    samples = [*straight_run(y=0.3)[:50], *straight_run(y=-0.4)[:50]]

    error = path_error(samples, PATH)

    assert error.maximum == pytest.approx(0.4)
    assert error.rms == pytest.approx(math.sqrt((0.09 + 0.16) / 2))


def test_comfort_counts_the_samples_outside_the_safe_region():
    angle = -math.atan(2.0 * 2.62 / 5.0**2)  # at 5 m/s exactly on the boundary
    inside = Sample(0.0, 0.0, 0.0, 0.0, 4.99, angle, angle, 5.0)

    judged = comfort([inside, inside, inside, replace(inside, v=6.0)], PARAMETERS)

    assert judged.violation_fraction == 0.25
    assert judged.peak_lateral_acceleration == pytest.approx(2.0 * 36 / 25)
    assert judged.least_speed_margin == pytest.approx(-1.0)
    assert comfort([inside], PARAMETERS).violation_fraction == 0.0


def test_total_variation_sums_every_change():
    assert total_variation([0.0, 1.0, -1.0, -1.0, 0.5]) == pytest.approx(4.5)
    assert total_variation([3.0]) == 0.0


def test_latency_percentiles_are_measured_values():
    summary = latency_summary(range(100, 0, -1))

    assert (summary.count, summary.p50, summary.p95, summary.p99) == (100, 50, 95, 99)
    assert summary.maximum == 100


def test_latency_of_one_and_of_none():
    assert latency_summary([0.002]).p50 == latency_summary([0.002]).maximum == 0.002
    empty = latency_summary([])
    assert empty.count == 0
    assert math.isnan(empty.p99)


@given(values=st.lists(st.floats(0, 10), min_size=1))
def test_latency_percentiles_are_ordered(values):
    summary = latency_summary(values)

    assert summary.p50 <= summary.p95 <= summary.p99 <= summary.maximum == max(values)


def test_gap_of_a_run_that_is_late():
    difference = gap(straight_run(), straight_run(late=0.25))

    assert difference.position == pytest.approx(0.5)
    assert difference.speed_rms == 0.0
    assert difference.activity_ratio == 1.0


def test_gap_interpolates_between_samples():
    shifted = [replace(sample, t=sample.t + 0.033, x=sample.x + 0.066) for sample in straight_run()]

    assert gap(straight_run(), shifted).position == pytest.approx(0.0, abs=1e-9)


def test_gap_tells_the_wilder_steering():
    calm = [replace(sample, delta=0.1 * math.sin(sample.t)) for sample in straight_run()]
    wild = [replace(sample, delta=2 * sample.delta) for sample in calm]

    assert gap(calm, wild).activity_ratio == pytest.approx(2.0)
    assert gap(calm, wild).steering_rms > 0.05
    assert gap(straight_run(), wild).activity_ratio == math.inf


def test_runs_at_different_times_have_no_gap():
    later = [replace(sample, t=sample.t + 100.0) for sample in straight_run()]

    with pytest.raises(ValueError, match="overlap"):
        gap(straight_run(), later)


def test_closeness_forgives_a_shift_in_time():
    one, two = straight_run(), straight_run(late=0.3)

    assert closeness(one, two, tau=0.0) == pytest.approx(0.6)
    # Where both runs have driven the same stretch, nothing but the shift parts them.
    assert closeness(one[20:80], two[23:83], tau=0.3001) == pytest.approx(0.0, abs=1e-9)


def test_closeness_is_symmetric_and_takes_another_distance():
    one, two = straight_run(speed=2.0), straight_run(speed=2.5)

    def by_speed(first: Sample, second: Sample) -> float:
        return abs(first.v - second.v)

    assert closeness(one, two, 0.1) == closeness(two, one, 0.1) > 0.0
    assert closeness(one, two, 0.1, by_speed) == pytest.approx(0.5)
    assert closeness(one, two[:5], 0.1) == math.inf


@pytest.mark.parametrize("judge", [lambda: path_error([], PATH), lambda: comfort([], PARAMETERS)])
def test_an_empty_run_cannot_be_judged(judge):
    assert callable(judge)
    with pytest.raises(ValueError, match="without samples"):
        judge()


@given(rows=st.lists(st.builds(Sample, *[NUMBERS] * 8), max_size=5))
def test_a_log_reads_back_exactly(rows, tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "run.csv"

    write_log(path, rows)

    assert read_log(path) == rows


def test_a_log_written_as_it_comes_has_a_header_and_plain_rows(tmp_path):
    path = tmp_path / "run.csv"
    with LogWriter(path) as log:
        log.write(Sample(0.0, 1.0, 2.0, 3.0, 4.0, -0.1, -0.2, 5))

    assert path.read_text() == HEADER + "0.0,1.0,2.0,3.0,4.0,-0.1,-0.2,5.0\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "run.csv:1: header"),
        ("t,x\n", "run.csv:1: header"),
        (HEADER + "1,2,3\n", "run.csv:2: expected 8"),
        (HEADER + "1,2,3,4,5,6,7,8\n1,2,3,4,5,6,7,eight\n", "run.csv:3: could not convert"),
        (HEADER + "1,2,3,4,5,6,7,nan\n", "run.csv:2: expected 8 finite"),
    ],
)
def test_a_broken_log_is_told_by_file_and_line(tmp_path, text, message):
    path = tmp_path / "run.csv"
    path.write_text(text)

    with pytest.raises(ValueError, match=message):
        read_log(path)


def test_table_aligns_numbers_right_and_words_left():
    table = Table("run", "error (m)", "count")
    table.add("J", 0.25501, 7)
    table.add("delayed", 12.5, 12345)

    assert table.render().splitlines() == [
        "run      error (m)  count",
        "-------  ---------  -----",
        "J            0.255      7",
        "delayed       12.5  12345",
    ]


def test_table_refuses_a_row_of_another_width():
    with pytest.raises(ValueError, match="2 cells"):
        Table("a", "b").add(1.0)
