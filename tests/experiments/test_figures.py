"""Figures of the right turn: all that shall be seen is drawn, and equal data gives equal files."""

import math

import pytest
from catvehicle.metrics import Sample
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight

from experiments.right_turn import comparisons, style, turns

PARAMETERS = VehicleParameters()
PATH = StraightArcStraight.right_turn(PARAMETERS)


def drive(offset=0.0, wiggle=0.0):
    """A drive along the path, some metres beside it, whose tyres swing by so many radians."""
    samples = []
    for index in range(200):
        pose = PATH.points(0.5)[min(index, len(PATH.points(0.5)) - 1)]
        delta = -0.1 * math.sin(index / 30) + wiggle * math.sin(index)
        samples.append(
            Sample(0.1 * index, pose.x, pose.y + offset, pose.psi, 4.0, delta, delta, 4.0)
        )
    return samples


def texts(figure):
    """All words of a figure."""
    return " ".join(
        artist.get_text() for artist in figure.findobj(lambda it: hasattr(it, "get_text"))
    )


def turn_figure():
    rows = [turns.Turns("JAUS alone", [drive(), drive(0.1)]), turns.Turns("ROS", [drive(0.3)])]
    return turns.draw(rows, PATH, PARAMETERS)


def test_both_rows_of_the_turn_have_the_same_axes():
    figure = turn_figure()
    paths, regions = figure.axes[0:4:2], figure.axes[1:4:2]
    for column in (paths, regions):
        assert len({(axes.get_xlim(), axes.get_ylim()) for axes in column}) == 1
    assert paths[0].get_ylim()[1] > 0.3


@pytest.mark.slow
def test_the_boundary_of_the_safe_region_is_where_the_acceleration_is_the_limit():
    region = turn_figure().axes[1]
    curve = next(line for line in region.lines if "boundary" in line.get_label())
    degrees, speed = curve.get_xdata()[0], curve.get_ydata()[0]
    sideways = speed**2 * abs(math.tan(math.radians(degrees))) / PARAMETERS.wheelbase
    assert sideways == pytest.approx(PARAMETERS.lateral_acceleration_limit)


def test_a_drive_without_samples_is_refused():
    with pytest.raises(ValueError, match="JAUS alone: a drive without samples"):
        turns.Turns("JAUS alone", [[]])


@pytest.mark.slow
def test_equal_figures_give_equal_files(tmp_path):
    first = style.store(turn_figure(), tmp_path / "one", "turn")
    second = style.store(turn_figure(), tmp_path / "two", "turn")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    assert [path.suffix for path in first] == [".svg", ".png"]
    assert b"dc:date" not in first[0].read_bytes()


def test_delays_tell_their_median_and_their_tail():
    times = [0.001 * (index + 1) for index in range(100)]
    figure = comparisons.latencies({"to_controller": {"J": times, "R": times}, "to_vehicle": {}})
    assert "median 50, 99 % 99" in texts(figure)
    assert len(figure.axes) == 1


def test_long_delays_are_told_as_numbers():
    figure = comparisons.latencies({"to_controller": {"J": [0.12] * 90 + [1.234] * 10}})
    assert "median 120, 99 % 1,234" in texts(figure)


def test_delays_that_nobody_measured_are_refused():
    with pytest.raises(ValueError, match="no message"):
        comparisons.latencies({"to_controller": {"J": []}})


def test_steering_is_summed_over_a_drive():
    figure = comparisons.steering({"J": [drive()], "R": [drive(wiggle=0.05)]})
    calm, wild = (line.get_ydata()[-1] for line in figure.axes[1].lines)
    assert wild > 5 * calm > 0


def test_a_hundredth_more_steering_does_not_look_wild():
    figure = comparisons.steering({"J": [drive(wiggle=0.05)], "R": [drive(wiggle=0.0505)]})
    low, high = figure.axes[2].get_ylim()
    assert low <= 0 < high


@pytest.mark.slow
def test_gaps_are_of_all_pairs():
    drives = [drive(0.01 * number) for number in range(8)]
    figure = comparisons.gaps(drives, drives)
    assert "R from J, 64 pairs" in texts(figure)
    assert "J from J, 28 pairs" in texts(figure)


def test_gaps_are_those_of_pairs_at_equal_times():
    figure = comparisons.gaps([drive(), drive(0.1)], [drive(0.3)])
    across, null = figure.axes[0].lines
    assert max(across.get_ydata()) == pytest.approx((0.3 + 0.2) / 2)
    assert max(null.get_ydata()) == pytest.approx(0.1)
