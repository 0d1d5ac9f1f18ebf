"""Conversions: absolute vectors, agreement with rotation matrices, calendar edges."""

import math
from array import array
from datetime import datetime, timedelta, timezone
from types import SimpleNamespace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from jausml.runtime import conversions as c

ANGLE = st.floats(-math.pi, math.pi)
PITCH = st.floats(-math.pi / 2, math.pi / 2)


# --------------------------------------------------------------- numbers


def test_numbers():
    assert c.negate(2.5) == -2.5
    assert c.scale(3.0, -0.5) == -1.5
    assert c.linear(20.0, 1.8, 32.0) == 68.0
    assert [c.clamp(v, -1.0, 2.0) for v in (-5.0, 0.5, 9.0)] == [-1.0, 0.5, 2.0]
    assert [c.deadband(v, 0.1) for v in (-0.2, -0.05, 0.0, 0.1)] == [-0.2, 0.0, 0.0, 0.1]
    assert c.square(-3.0) == 9.0
    assert c.degrees_to_radians(180.0) == math.pi
    assert c.radians_to_degrees(-math.pi / 2) == -90.0


def test_roots():
    assert c.square_root(6.25) == 2.5
    assert c.square_root(0.0) == 0.0
    assert math.isnan(c.square_root(-1.0))
    assert math.isnan(c.square_root(math.nan))


def test_covariance_to_rms():
    # Standard deviations of 1, 2 and 2 m: the mean of 1, 4 and 4 m2 is 3 m2.
    assert c.covariance_to_rms(1.0, 4.0, 4.0) == math.sqrt(3.0)
    assert c.covariance_to_rms(0.04, 0.04, 0.04) == pytest.approx(0.2)
    assert c.covariance_to_rms(3.0, 0.0, 0.0) == 1.0


@pytest.mark.parametrize(
    "variances", [(0.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (1.0, -1.0, 1.0), (1.0, 1.0, math.nan)]
)
def test_unknown_variances_have_no_rms(variances):
    assert math.isnan(c.covariance_to_rms(*variances))


def test_percent():
    assert c.value_to_percent(2.0, 8.0) == 25.0
    assert c.percent_to_value(25.0, 8.0) == 2.0
    # A negative maximum is that of an inverted axis.
    assert c.value_to_percent(2.0, -8.0) == -25.0
    assert c.percent_to_value(-25.0, -8.0) == 2.0
    with pytest.raises(c.ConversionError, match="percentage of zero"):
        c.value_to_percent(2.0, 0.0)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.sampled_from([1.0, -1.0]))
def test_percent_and_back(value, maximum, sign):
    maximum *= sign
    percent = c.value_to_percent(value, maximum)
    assert c.percent_to_value(percent, maximum) == pytest.approx(value, rel=1e-12, abs=1e-12)


def test_look_up():
    gears = {"PARK": 0, "DRIVE": 4}
    assert c.look_up("DRIVE", gears) == 4
    assert c.look_up(True, {0: "off", 1: "on"}) == "on"
    with pytest.raises(c.ConversionError, match="'REVERSE' is not in the table"):
        c.look_up("REVERSE", gears)


def test_clamp_hides_no_nan():
    assert math.isnan(c.clamp(math.nan, -1.0, 1.0))


# --------------------------------------------------------------- headings


@pytest.mark.parametrize(
    ("heading", "yaw"),
    [
        (0.0, math.pi / 2),  # north
        (math.pi / 2, 0.0),  # east
        (math.pi, -math.pi / 2),  # south
        (-math.pi / 2, math.pi),  # west
    ],
)
def test_compass(heading, yaw):
    def off(a, b):
        return abs(math.remainder(a - b, math.tau))

    assert off(c.ned_heading_to_enu_yaw(heading), yaw) < 1e-12
    assert off(c.enu_yaw_to_ned_heading(yaw), heading) < 1e-12


@given(st.floats(-1e4, 1e4))
def test_a_wrapped_angle_has_the_same_direction(angle):
    wrapped = c.wrap_angle(angle)
    assert -math.pi <= wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@given(st.floats(-50, 50))
def test_headings_stay_in_the_jaus_range(angle):
    assert -math.pi <= c.enu_yaw_to_ned_heading(angle) <= math.pi


# --------------------------------------------------------------- orientations


def matrix(q):
    """Rotation matrix of a unit quaternion."""
    x, y, z, w = q
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def times(*matrices):
    product, *rest = matrices
    for m in rest:
        product = [
            [sum(product[i][k] * m[k][j] for k in range(3)) for j in range(3)] for i in range(3)
        ]
    return product


def about(axis, angle):
    """Elementary rotation, right-handed, written out from the definition."""
    s, co = math.sin(angle), math.cos(angle)
    return {
        "x": [[1, 0, 0], [0, co, -s], [0, s, co]],
        "y": [[co, 0, s], [0, 1, 0], [-s, 0, co]],
        "z": [[co, -s, 0], [s, co, 0], [0, 0, 1]],
    }[axis]


def attitude(roll, pitch, yaw):
    return times(about("z", yaw), about("y", pitch), about("x", roll))


def distance(a, b):
    return max(abs(a[i][j] - b[i][j]) for i in range(3) for j in range(3))


FLIP = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]  # forward-right-down <-> forward-left-up
SWAP = [[0, 1, 0], [1, 0, 0], [0, 0, -1]]  # north-east-down <-> east-north-up


def forward(q):
    return [row[0] for row in matrix(q)]


def left(q):
    return [row[1] for row in matrix(q)]


def near(a, b):
    return all(abs(x - y) < 1e-12 for x, y in zip(a, b, strict=True))


def test_absolute_attitudes_on_the_earth():
    facing_north = c.ned_angles_to_enu_quaternion(0, 0, 0)
    facing_east = c.ned_angles_to_enu_quaternion(0, 0, math.pi / 2)
    nose_up = c.ned_angles_to_enu_quaternion(0, math.pi / 2, 0)
    rolled_right = c.ned_angles_to_enu_quaternion(math.pi / 2, 0, 0)
    assert near(forward(facing_north), [0, 1, 0])
    assert near(left(facing_north), [-1, 0, 0])
    assert near(forward(facing_east), [1, 0, 0])
    assert near(forward(nose_up), [0, 0, 1])
    assert near(left(rolled_right), [0, 0, 1])


def quaternion(rotation):
    """Unit quaternion of a rotation matrix, by its largest part."""
    ((a, b, d), (e, f, g), (h, i, j)) = rotation
    squares = [1 + a - f - j, 1 - a + f - j, 1 - a - f + j, 1 + a + f + j]
    largest = squares.index(max(squares))
    parts = [
        (squares[0], b + e, d + h, i - g),
        (b + e, squares[1], g + i, d - h),
        (d + h, g + i, squares[2], e - b),
        (i - g, d - h, e - b, squares[3]),
    ][largest]
    length = math.sqrt(sum(part * part for part in parts))
    return c.Quaternion(*(part / length for part in parts))


def in_earth(forward, left, up):
    """The orientation of a body by the directions of its axes in east, north, up."""
    return quaternion([list(row) for row in zip(forward, left, up, strict=True)])


EAST, NORTH, UP = (1, 0, 0), (0, 1, 0), (0, 0, 1)
WEST, SOUTH, DOWN = (-1, 0, 0), (0, -1, 0), (0, 0, -1)
QUARTER = math.pi / 2


@pytest.mark.parametrize(
    ("axes", "roll", "pitch", "heading"),
    [
        pytest.param((NORTH, WEST, UP), 0, 0, 0, id="faces north"),
        pytest.param((EAST, NORTH, UP), 0, 0, QUARTER, id="faces east"),
        pytest.param((SOUTH, EAST, UP), 0, 0, math.pi, id="faces south"),
        pytest.param((WEST, SOUTH, UP), 0, 0, -QUARTER, id="faces west"),
        pytest.param((NORTH, DOWN, WEST), -QUARTER, 0, 0, id="north, left wing down"),
        pytest.param((NORTH, UP, EAST), QUARTER, 0, 0, id="north, right wing down"),
        pytest.param((EAST, DOWN, NORTH), -QUARTER, 0, QUARTER, id="east, left wing down"),
        pytest.param((NORTH, EAST, DOWN), math.pi, 0, 0, id="north, upside down"),
        pytest.param((WEST, NORTH, DOWN), math.pi, 0, -QUARTER, id="west, upside down"),
    ],
)
def test_absolute_attitudes_from_orientations_on_the_earth(axes, roll, pitch, heading):
    angles = c.enu_quaternion_to_ned_angles(in_earth(*axes))
    for found, expected in zip(angles, (roll, pitch, heading), strict=True):
        assert abs(math.remainder(found - expected, math.tau)) < 1e-12
    assert c.enu_quaternion_to_ned_heading(in_earth(*axes)) == angles.yaw


@given(ANGLE, PITCH, ANGLE, st.floats(0.1, 10))
def test_angles_in_north_east_down_agree_with_matrices(roll, pitch, heading, length):
    # The body's axes in north-east-down by matrices alone, then both sides turned to ROS axes.
    rotation = times(SWAP, attitude(roll, pitch, heading), FLIP)
    orientation = c.Quaternion(*(part * length for part in quaternion(rotation)))
    found = c.enu_quaternion_to_ned_angles(orientation)
    assert distance(attitude(*found), attitude(roll, pitch, heading)) < 1e-5
    assert c.enu_quaternion_to_ned_heading(orientation) == found.yaw
    assert -math.pi <= found.yaw <= math.pi


@given(ANGLE, PITCH, ANGLE)
def test_angles_of_a_body_agree_with_matrices(roll, pitch, yaw):
    rotation = times(FLIP, attitude(roll, pitch, yaw), FLIP)
    found = c.flu_quaternion_to_frd_angles(quaternion(rotation))
    assert distance(attitude(*found), attitude(roll, pitch, yaw)) < 1e-5


@pytest.mark.parametrize("roll", [3.0, math.pi, -3.0])
@pytest.mark.parametrize("pitch", [-QUARTER, 1e-7 - QUARTER, QUARTER - 1e-7, QUARTER])
@pytest.mark.parametrize("heading", [-2.0, 0.0, 1.0])
def test_upside_down_near_the_vertical(roll, pitch, heading):
    rotation = times(SWAP, attitude(roll, pitch, heading), FLIP)
    found = c.enu_quaternion_to_ned_angles(quaternion(rotation))
    assert distance(attitude(*found), attitude(roll, pitch, heading)) < 1e-5


@given(ANGLE)
def test_heading_or_yaw_alone_is_the_general_case(angle):
    for alone, general in (
        (c.ned_heading_to_enu_quaternion, c.ned_angles_to_enu_quaternion),
        (c.frd_yaw_to_flu_quaternion, c.frd_angles_to_flu_quaternion),
    ):
        assert distance(matrix(alone(angle)), matrix(general(0.0, 0.0, angle))) < 1e-12


@given(ANGLE, PITCH, ANGLE)
def test_orientations_of_bodies_and_on_the_earth_agree_with_matrices(roll, pitch, yaw):
    body = times(FLIP, attitude(roll, pitch, yaw), FLIP)
    earth = times(SWAP, attitude(roll, pitch, yaw), FLIP)
    assert distance(matrix(c.frd_angles_to_flu_quaternion(roll, pitch, yaw)), body) < 1e-12
    assert distance(matrix(c.ned_angles_to_enu_quaternion(roll, pitch, yaw)), earth) < 1e-12


def angles_of(q):
    """Roll, pitch and yaw, each by the function that gives it alone."""
    return (
        c.flu_quaternion_to_frd_roll(q),
        c.flu_quaternion_to_frd_pitch(q),
        c.flu_quaternion_to_frd_yaw(q),
    )


@given(*[st.floats(-1, 1)] * 4, st.floats(0.1, 10))
def test_angles_of_any_orientation_give_it_back(x, y, z, w, length):
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    assume(norm > 1e-3)
    unit = [v / norm for v in (x, y, z, w)]
    q = c.Quaternion(*(v * length for v in unit))  # readers must not rely on unit length
    roll, pitch, yaw = angles_of(q)
    assert -math.pi <= roll <= math.pi
    assert -math.pi / 2 <= pitch <= math.pi / 2
    assert -math.pi <= yaw <= math.pi
    # The sine of pitch is flat at the vertical: there an error of 1e-16 is one of 1e-8 in angle.
    assert distance(times(FLIP, attitude(roll, pitch, yaw), FLIP), matrix(unit)) < 1e-5


@pytest.mark.parametrize("yaw", [-2.0, 0.0, 1.0])
@pytest.mark.parametrize("pitch", [-math.pi / 2, math.pi / 2])
def test_vertical_attitudes(pitch, yaw):
    q = c.frd_angles_to_flu_quaternion(0.7, pitch, yaw)
    angles = angles_of(q)
    assert angles[0] == 0.0
    assert distance(times(FLIP, attitude(*angles), FLIP), matrix(q)) < 1e-5


@pytest.mark.parametrize(
    "function",
    [
        c.flu_quaternion_to_frd_roll,
        c.flu_quaternion_to_frd_pitch,
        c.flu_quaternion_to_frd_yaw,
        c.enu_quaternion_to_ned_heading,
        lambda q: sum(c.flu_quaternion_to_frd_angles(q)),
        lambda q: sum(c.enu_quaternion_to_ned_angles(q)),
    ],
)
@pytest.mark.parametrize(
    "parts", [(0.0, 0.0, 0.0, 0.0), (math.nan, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, math.inf)]
)
def test_what_is_no_orientation_has_no_angles(function, parts):
    """Not a number goes to the policy of the target field."""
    assert math.isnan(function(c.Quaternion(*parts)))


@pytest.mark.parametrize(
    "function", [c.ned_heading_to_enu_yaw, c.enu_yaw_to_ned_heading, c.wrap_angle]
)
@pytest.mark.parametrize("angle", [math.nan, math.inf, -math.inf])
def test_what_is_no_angle_has_no_direction(function, angle):
    assert math.isnan(function(angle))


@pytest.mark.parametrize("angle", [math.inf, -math.inf])
def test_an_infinite_angle_gives_no_orientation(angle):
    """Not a number goes to the policy of the target field."""
    for function in (c.frd_angles_to_flu_quaternion, c.ned_angles_to_enu_quaternion):
        for angles in ((angle, 0.0, 0.0), (0.0, angle, 0.0), (0.0, 0.0, angle)):
            assert all(map(math.isnan, function(*angles)))
    for function in (c.frd_yaw_to_flu_quaternion, c.ned_heading_to_enu_quaternion):
        assert all(map(math.isnan, function(angle)[2:]))


# --------------------------------------------------------------- grids


def test_occupancy_and_cost():
    occupancies = [-1, 0, 1, 50, 99, 100]
    costs = [255, 0, 3, 127, 251, 254]
    assert [c.occupancy_to_cost(float(occupancy)) for occupancy in occupancies] == costs
    assert [c.cost_to_occupancy(float(cost)) for cost in costs] == occupancies


def test_each_occupancy_returns():
    for occupancy in range(-1, 101):
        assert c.cost_to_occupancy(c.occupancy_to_cost(occupancy)) == occupancy


def test_each_cost_returns_within_one():
    for cost in range(255):
        assert abs(c.occupancy_to_cost(c.cost_to_occupancy(cost)) - cost) <= 1
    assert c.occupancy_to_cost(c.cost_to_occupancy(255)) == 255


@pytest.mark.parametrize("value", [-2.0, -0.5, 100.5, 127.0, math.nan, math.inf])
def test_no_occupancy(value):
    with pytest.raises(c.ConversionError, match="is no occupancy"):
        c.occupancy_to_cost(value)


@pytest.mark.parametrize("value", [-1.0, 255.5, 256.0, math.nan, math.inf])
def test_no_cost(value):
    with pytest.raises(c.ConversionError, match="is no cost"):
        c.cost_to_occupancy(value)


def test_reverse_rows():
    assert c.reverse_rows([1, 2, 3, 4, 5, 6], 3) == [4, 5, 6, 1, 2, 3]
    assert c.reverse_rows([1, 2, 3, 4, 5, 6], 2) == [5, 6, 3, 4, 1, 2]
    assert c.reverse_rows([1, 2, 3], 3) == [1, 2, 3]
    assert c.reverse_rows([1, 2, 3], 1.0) == [3, 2, 1]
    assert c.reverse_rows(array("b", [1, 2, 3, 4]), 2) == [3, 4, 1, 2]
    assert c.reverse_rows([], 0) == []


@pytest.mark.parametrize("columns", [0, -3, 4, 7, 1.5, math.nan, math.inf])
def test_rows_that_cells_do_not_fill(columns):
    with pytest.raises(c.ConversionError, match="do not fill rows"):
        c.reverse_rows([1, 2, 3, 4, 5, 6], columns)


@given(st.integers(1, 9), st.integers(0, 9))
def test_reversed_rows_return(columns, rows):
    cells = list(range(columns * rows))
    assert c.reverse_rows(c.reverse_rows(cells, columns), columns) == cells


# --------------------------------------------------------------- times


def instant(text):
    moment = datetime.fromisoformat(text).replace(tzinfo=timezone.utc)
    return c.Time(int(moment.timestamp()), 0)


def stamp(day, hour=0, minutes=0, seconds=0, milliseconds=0):
    return c.TimeStamp(milliseconds, seconds, minutes, hour, day)


def test_time_to_timestamp():
    found = c.time_to_timestamp(c.Time(instant("2024-02-29T23:59:58").sec, 999_999_999))
    assert found == c.TimeStamp(milliseconds=999, seconds=58, minutes=59, hour=23, day=29)


@pytest.mark.parametrize(
    ("received", "now", "expected"),
    [
        (stamp(15, 12), "2026-06-15T12:00:01", "2026-06-15T12:00:00"),
        # Sent on the last of the month, received on the first, and clocks the other way round.
        (stamp(30, 23, 59, 59), "2026-07-01T00:00:00", "2026-06-30T23:59:59"),
        (stamp(1, 0, 0, 1), "2026-06-30T23:59:59", "2026-07-01T00:00:01"),
        # Year.
        (stamp(31, 23, 59, 59), "2027-01-01T00:00:00", "2026-12-31T23:59:59"),
        (stamp(1), "2026-12-31T23:59:59", "2027-01-01T00:00:00"),
        # February, short and long; days that it lacks.
        (stamp(28, 23), "2026-03-01T01:00:00", "2026-02-28T23:00:00"),
        (stamp(29, 23), "2024-03-01T01:00:00", "2024-02-29T23:00:00"),
        (stamp(31), "2026-02-10T00:00:00", "2026-01-31T00:00:00"),
        (stamp(30), "2026-02-27T00:00:00", "2026-01-30T00:00:00"),
        # Two months back, where the month before has no such day.
        (stamp(31, 12), "2026-03-01T00:00:00", "2026-01-31T12:00:00"),
        (stamp(31), "2026-03-03T00:00:00", "2026-03-31T00:00:00"),
        (stamp(31, 1), "2024-03-01T00:00:00", "2024-01-31T01:00:00"),
        (stamp(31), "2024-03-01T01:00:00", "2024-03-31T00:00:00"),
        # Before the first clock message of a simulation.
        (stamp(1, 6), "1970-01-01T00:00:00", "1970-01-01T06:00:00"),
        # A peer that leaves the day at 0, around midnight.
        (stamp(0, 23, 59), "2026-06-15T00:01:00", "2026-06-14T23:59:00"),
        (stamp(0, 0, 1), "2026-06-14T23:59:00", "2026-06-15T00:01:00"),
    ],
)
def test_timestamp_to_time(received, now, expected):
    assert c.timestamp_to_time(received, near=instant(now)) == instant(expected)


@pytest.mark.parametrize(
    "wrong",
    [stamp(1, hour=24), stamp(1, minutes=60), stamp(1, seconds=60), stamp(1, milliseconds=1000)],
)
def test_no_time_of_day(wrong):
    with pytest.raises(c.ConversionError):
        c.timestamp_to_time(wrong, near=c.Time(0, 0))


@given(
    st.datetimes(datetime(1971, 1, 1), datetime(2037, 12, 1)),
    st.timedeltas(timedelta(days=-13), timedelta(days=13)),
    st.integers(0, 999),
)
def test_time_crosses_and_returns(moment, skew, milliseconds):
    seconds = int(moment.replace(tzinfo=timezone.utc).timestamp())
    sent = c.Time(seconds, milliseconds * 10**6)
    now = c.Time(seconds + int(skew.total_seconds()), 0)
    assert c.timestamp_to_time(c.time_to_timestamp(sent), near=now) == sent


def test_objects_with_the_attributes_do():
    message = SimpleNamespace(sec=86_399, nanosec=5_000_000)
    assert c.time_to_timestamp(message) == c.TimeStamp(5, 59, 59, 23, 1)
