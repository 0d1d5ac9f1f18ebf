"""Steering law, velocity law and dead reckoning, each on its own."""

import math

import pytest
from catvehicle import (
    BicyclePlant,
    DeadReckoning,
    Pose,
    SteeringController,
    StraightArcStraight,
    VehicleParameters,
    VelocityController,
)
from catvehicle.velocity import lateral_acceleration, safe_speed
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

PARAMETERS = VehicleParameters()
PATH = StraightArcStraight.right_turn(PARAMETERS)
STEERING = SteeringController(PARAMETERS, PATH)
VELOCITY = VelocityController(PARAMETERS)


def test_on_the_straight_the_tyres_are_straight():
    assert STEERING.command(Pose(5.0, 0.0, 0.0), 4.0) == 0.0


def test_left_of_the_path_steers_right_by_the_law():
    angle = STEERING.command(Pose(5.0, 1.0, 0.0), 4.0)

    assert angle == pytest.approx(-math.atan2(0.7 * 1.0, 4.0))
    assert angle < 0.0


def test_right_of_the_path_steers_left():
    assert STEERING.command(Pose(5.0, -1.0, 0.0), 4.0) > 0.0


def test_heading_left_of_the_path_steers_right():
    # The front axle is on the path, so that only the heading speaks.
    pose = Pose(5.0, -PARAMETERS.wheelbase * math.sin(0.1), 0.1)

    assert STEERING.command(pose, 4.0) == pytest.approx(-0.1)


def test_the_front_axle_meets_the_arc_first():
    # Rear axle 1.62 m before the arc, front axle 1 m into it: steers right already.
    assert STEERING.command(Pose(25.0 - 1.62, 0.0, 0.0), 5.0) < -0.05


def test_a_yaw_of_full_turns_steers_the_same():
    pose = Pose(36.8, -25.0, -1.5)
    turned = Pose(pose.x, pose.y, pose.psi + 4 * math.pi)

    assert STEERING.command(turned, 4.0) == pytest.approx(STEERING.command(pose, 4.0))


def test_standing_still_the_law_divides_by_the_speed_floor():
    pose = Pose(5.0, 0.2, 0.0)

    assert STEERING.command(pose, 0.0) == STEERING.command(pose, PARAMETERS.steering_speed_floor)


@given(x=st.floats(-50, 80), y=st.floats(-80, 50), psi=st.floats(-7, 7), v=st.floats(-1, 20))
def test_steering_command_stays_within_the_limit(x, y, psi, v):
    assert abs(STEERING.command(Pose(x, y, psi), v)) <= PARAMETERS.steering_limit


@for_each(
    ("bound", "degrees", "speed"),
    [
        (2.0, 2, 12.3),
        (2.0, 5, 7.7),
        (2.0, 10, 5.5),
        (2.0, 20, 3.8),
        (2.0, 30, 3.0),
        (1.5, 15, 3.8),
        (3.0, 25, 4.1),
    ],
)
def test_safe_speed_for_a_tyre_angle(bound, degrees, speed):
    parameters = VehicleParameters(lateral_acceleration_limit=bound)

    assert safe_speed(math.radians(degrees), parameters) == pytest.approx(speed, abs=0.06)
    assert safe_speed(math.radians(-degrees), parameters) == pytest.approx(speed, abs=0.06)


@given(angle=st.floats(1e-3, 0.5))
def test_safe_speed_is_where_the_lateral_acceleration_meets_its_limit(angle):
    speed = safe_speed(-angle, PARAMETERS)

    assert lateral_acceleration(speed, angle, PARAMETERS.wheelbase) == pytest.approx(2.0)


def test_straight_tyres_have_no_safe_speed():
    assert safe_speed(0.0, PARAMETERS) == math.inf


def test_velocity_is_the_reference_on_the_straight():
    assert VELOCITY.command(0.0, 0.0, remaining=60.0) == PARAMETERS.reference_speed


@pytest.mark.parametrize(("measured", "commanded"), [(-0.3, 0.0), (0.0, -0.3), (0.3, 0.1)])
def test_velocity_heeds_the_larger_of_measured_and_commanded_angle(measured, commanded):
    speed = VELOCITY.command(measured, commanded, remaining=60.0)

    assert speed == pytest.approx(0.85 * safe_speed(0.3, PARAMETERS))


def test_velocity_falls_to_zero_at_the_end_and_stays_zero_behind_it():
    speeds = [VELOCITY.command(0.0, 0.0, remaining) for remaining in (20, 8, 4, 1, 0, -3)]

    assert speeds == pytest.approx([6.0, 4.0, 2.0, 0.5, 0.0, 0.0])


@given(measured=st.floats(-0.53, 0.53), commanded=st.floats(-0.53, 0.53), rest=st.floats(-9, 99))
def test_commanded_velocity_is_comfortable(measured, commanded, rest):
    speed = VELOCITY.command(measured, commanded, rest)

    assert 0.0 <= speed <= PARAMETERS.reference_speed
    for angle in (measured, commanded):
        sideways = lateral_acceleration(speed, angle, PARAMETERS.wheelbase)
        assert sideways <= 0.85**2 * 2.0 + 1e-9


def test_dead_reckoning_follows_the_plant():
    plant = BicyclePlant(PARAMETERS)
    reckoning = DeadReckoning(PARAMETERS)
    for index in range(250):
        if index == 25:
            plant.command(5.0, -0.2)
        state = plant.state
        pose = reckoning.update(100.0 + 0.04 * index, state.v, state.delta)
        assert math.hypot(pose.x - state.x, pose.y - state.y) < 0.02
        plant.advance(0.04)
    assert pose.psi == pytest.approx(state.psi, abs=2e-3)
    assert pose.psi < -1.0


def test_dead_reckoning_turns_right_for_a_negative_angle():
    reckoning = DeadReckoning(PARAMETERS)
    reckoning.update(0.0, 4.0, -0.1)

    pose = reckoning.update(1.0, 4.0, -0.1)

    assert pose.psi == pytest.approx(-4.0 * math.tan(0.1) / 2.62)
    assert pose.x > 3.9
    assert pose.y < 0.0


def test_the_first_report_only_sets_the_clock():
    reckoning = DeadReckoning(PARAMETERS, Pose(1.0, 2.0, 0.5))
    assert reckoning.time is None

    assert reckoning.update(1000.0, 5.0, 0.1) == Pose(1.0, 2.0, 0.5)
    assert reckoning.time == 1000.0


def test_late_and_repeated_reports_change_nothing():
    reckoning = DeadReckoning(PARAMETERS)
    reckoning.update(0.0, 4.0, 0.0)
    pose = reckoning.update(0.08, 4.0, 0.0)

    assert reckoning.update(0.04, 9.0, 0.3) == pose
    assert reckoning.update(0.08, 9.0, 0.3) == pose
    assert reckoning.update(0.12, 4.0, 0.0).x == pytest.approx(0.48)


@pytest.mark.parametrize(
    "report", [(math.nan, 1.0, 0.0), (0.04, math.inf, 0.0), (0.04, 1.0, math.nan)]
)
def test_a_report_that_is_not_finite_leaves_the_pose(report):
    reckoning = DeadReckoning(PARAMETERS)
    reckoning.update(0.0, 1.0, 0.0)

    with pytest.raises(ValueError, match="not finite"):
        reckoning.update(*report)

    assert reckoning.time == 0.0
