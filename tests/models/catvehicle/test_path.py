"""Geometry of the prescribed path, with absolute positions and signs."""

import math

import pytest
from catvehicle import Pose, StraightArcStraight, VehicleParameters, wrap_angle
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

RIGHT = StraightArcStraight.right_turn(VehicleParameters())
LEFT = StraightArcStraight(25.0, 12.0, math.pi / 2, 25.0)


def test_right_turn_ends_to_the_right_heading_south():
    end = RIGHT.at(RIGHT.length)

    assert RIGHT.length == pytest.approx(25 + 12 * math.pi / 2 + 25)
    assert (end.x, end.y, end.psi) == pytest.approx((37.0, -37.0, -math.pi / 2))


def test_left_turn_is_its_mirror_image():
    for station in range(0, 68, 3):
        right, left = RIGHT.at(station), LEFT.at(station)
        assert (left.x, left.y, left.psi) == pytest.approx((right.x, -right.y, -right.psi))


@for_each(
    ("path", "x", "y", "error", "station"),
    [
        (RIGHT, 10.0, 1.0, 1.0, 10.0),
        (RIGHT, 10.0, -1.0, -1.0, 10.0),
        # Outside of a right-hand arc is left of the path, its centre (25, -12) right of it.
        (RIGHT, 25 + 13 / math.sqrt(2), -12 + 13 / math.sqrt(2), 1.0, 25 + 3 * math.pi),
        (RIGHT, 25 + 11 / math.sqrt(2), -12 + 11 / math.sqrt(2), -1.0, 25 + 3 * math.pi),
        # Heading south, left is east.
        (RIGHT, 37.5, -20.0, 0.5, 25 + 6 * math.pi + 8),
        (RIGHT, 36.5, -20.0, -0.5, 25 + 6 * math.pi + 8),
        (LEFT, 37.5, 20.0, -0.5, 25 + 6 * math.pi + 8),
        (LEFT, 36.5, 20.0, 0.5, 25 + 6 * math.pi + 8),
        # Beyond the ends the straights go on.
        (RIGHT, -4.0, 0.3, 0.3, -4.0),
        (RIGHT, 37.2, -40.0, 0.2, 25 + 6 * math.pi + 28),
    ],
)
def test_cross_track_error_is_positive_left_of_the_path(path, x, y, error, station):
    nearest = path.nearest(x, y)

    assert nearest.cross_track_error == pytest.approx(error)
    assert nearest.station == pytest.approx(station)
    assert path.cross_track_error(x, y) == nearest.cross_track_error


def test_remaining_length_falls_to_zero_at_the_end_and_below_behind_it():
    assert RIGHT.remaining(0.0, 0.0) == pytest.approx(RIGHT.length)
    assert RIGHT.remaining(37.0, -37.0) == pytest.approx(0.0)
    assert RIGHT.remaining(37.0, -38.5) == pytest.approx(-1.5)


@given(
    turn=st.floats(0.1, 2.5).flatmap(lambda size: st.sampled_from([size, -size])),
    radius=st.floats(3.0, 50.0),
    share=st.floats(0.0, 1.0),
    offset=st.floats(-1.0, 1.0),
)
def test_a_point_beside_the_path_is_found_again(turn, radius, share, offset):
    path = StraightArcStraight(20.0, radius, turn, 20.0)
    station = share * path.length
    foot = path.at(station)
    x, y = foot.x - offset * math.sin(foot.psi), foot.y + offset * math.cos(foot.psi)

    nearest = path.nearest(x, y)

    assert nearest.station == pytest.approx(station, abs=1e-6)
    assert nearest.cross_track_error == pytest.approx(offset, abs=1e-6)
    assert nearest.pose.psi == pytest.approx(foot.psi, abs=1e-6)


@given(x=st.floats(-20, 60), y=st.floats(-60, 20))
def test_no_point_of_the_path_is_nearer_than_the_nearest(x, y):
    distance = abs(RIGHT.cross_track_error(x, y))

    assert all(
        math.hypot(x - pose.x, y - pose.y) >= distance - 1e-9 for pose in RIGHT.points(spacing=0.5)
    )


def test_points_reach_from_start_to_end():
    points = RIGHT.points(spacing=1.0)

    assert points[0] == Pose(0.0, 0.0, 0.0)
    assert points[-1] == RIGHT.at(RIGHT.length)
    assert len(points) == math.ceil(RIGHT.length) + 1


@given(angle=st.floats(-100, 100))
def test_wrapped_angle_points_the_same_way(angle):
    wrapped = wrap_angle(angle)

    assert -math.pi <= wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@for_each(
    "shape",
    [(0.0, 12.0, -1.0, 25.0), (25.0, -12.0, -1.0, 25.0), (25.0, 12.0, 0.0, 25.0), (25, 12, 4, 25)],
)
def test_impossible_shapes_are_refused(shape):
    with pytest.raises(ValueError, match="must be"):
        StraightArcStraight(*shape)
