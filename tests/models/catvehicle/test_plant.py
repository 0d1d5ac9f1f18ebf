"""The plant against closed forms, with absolute directions."""

import math

import pytest
from catvehicle import BicyclePlant, VehicleParameters, VehicleState
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

PARAMETERS = VehicleParameters()


def moving(speed: float, steering_angle: float, **changed: float) -> BicyclePlant:
    """Returns a plant at the origin that keeps a speed (m/s) and a tyre angle (rad)."""
    plant = BicyclePlant(VehicleParameters(**changed), VehicleState(v=speed, delta=steering_angle))
    plant.command(speed, steering_angle)
    return plant


def test_right_turn_has_negative_angle_and_yaw_rate_and_y_falls():
    plant = BicyclePlant(PARAMETERS)
    plant.command(4.0, -0.2)

    state = plant.advance(3.0)

    assert state.delta < 0.0
    assert plant.yaw_rate < 0.0
    assert state.psi < 0.0
    assert state.y < 0.0
    assert state.x > 0.0


def test_left_turn_mirrors_the_right_turn():
    left, right = BicyclePlant(PARAMETERS), BicyclePlant(PARAMETERS)
    left.command(4.0, 0.2)
    right.command(4.0, -0.2)

    one, two = left.advance(3.0), right.advance(3.0)

    assert (one.x, one.y, one.psi) == pytest.approx((two.x, -two.y, -two.psi))
    assert one.y > 0.0


def test_constant_steering_drives_the_circle_of_the_bicycle():
    angle = -math.atan(PARAMETERS.wheelbase / 12.0)
    plant = moving(4.0, angle)

    state = plant.advance(12.0 * math.pi / 2 / 4.0)

    assert (state.x, state.y, state.psi) == pytest.approx((12.0, -12.0, -math.pi / 2), abs=1e-6)


def test_lateral_acceleration_is_speed_times_yaw_rate():
    plant = moving(5.0, 0.1)

    assert plant.state.v * plant.yaw_rate == pytest.approx(25.0 * math.tan(0.1) / 2.62)


def test_understeer_widens_the_turn():
    plant = moving(6.0, -0.2, understeer_coefficient=0.0015)

    assert plant.yaw_rate == pytest.approx(-6.0 * math.tan(0.2 / 1.054) / 2.62)
    assert abs(plant.yaw_rate) < abs(moving(6.0, -0.2).yaw_rate)


def test_speed_lags_slower_up_than_down():
    up = moving(2.0, 0.0)
    up.command(3.0, 0.0)
    down = moving(3.0, 0.0)
    down.command(2.0, 0.0)

    assert up.advance(1.0).v == pytest.approx(3.0 - math.exp(-1.0 / 1.333), abs=1e-6)
    assert down.advance(1.0).v == pytest.approx(2.0 + math.exp(-1.0 / 0.667), abs=1e-6)


def test_acceleration_and_braking_saturate():
    start = BicyclePlant(PARAMETERS)
    start.command(8.0, 0.0)
    brake = moving(8.0, 0.0)
    brake.command(0.0, 0.0)

    assert start.advance(1.0).v == pytest.approx(2.0)
    assert brake.advance(1.0).v == pytest.approx(5.0)


def test_steering_rate_saturates_and_then_lags():
    plant = BicyclePlant(PARAMETERS)
    plant.command(0.0, -0.5)

    assert plant.advance(0.5).delta == pytest.approx(-0.3)
    # The lag takes over 0.15 rad from the target, 0.35 / 0.6 s after the start.
    rest = 1.0 - 0.35 / 0.6
    assert plant.advance(0.5).delta == pytest.approx(-0.5 + 0.15 * math.exp(-rest / 0.25), abs=1e-4)


def test_commands_saturate():
    plant = BicyclePlant(PARAMETERS)

    plant.command(100.0, -2.0)
    assert (plant.speed_command, plant.steering_command) == (8.94, -0.5297)
    plant.command(-1.0, 2.0)
    assert (plant.speed_command, plant.steering_command) == (0.0, 0.5297)


@given(
    commands=st.lists(
        st.tuples(st.floats(-20, 20), st.floats(-3, 3), st.floats(0, 0.5)), max_size=8
    )
)
def test_state_stays_within_its_limits(commands):
    plant = BicyclePlant(PARAMETERS)
    for speed, angle, dt in commands:
        plant.command(speed, angle)
        state = plant.advance(dt)
        assert 0.0 <= state.v <= PARAMETERS.speed_max
        assert abs(state.delta) <= PARAMETERS.steering_limit


@for_each("dt", [0.0, 1e-7, 0.0004, 0.001, 0.0015, 0.04, 0.0413, 1.0 / 3.0])
def test_advance_takes_exactly_the_time_asked_for(dt):
    state = moving(5.0, 0.0).advance(dt)

    assert state.x == pytest.approx(5.0 * dt, rel=1e-12)


def test_cutting_the_time_changes_nothing_that_matters():
    whole, cut = BicyclePlant(PARAMETERS), BicyclePlant(PARAMETERS)
    for plant in (whole, cut):
        plant.command(5.0, -0.2)

    one = whole.advance(2.0)
    for _ in range(7):
        two = cut.advance(2.0 / 7)

    assert (two.x, two.y, two.psi) == pytest.approx((one.x, one.y, one.psi), abs=1e-5)


@pytest.mark.parametrize("dt", [-0.01, math.nan, math.inf])
def test_impossible_times_are_refused(dt):
    with pytest.raises(ValueError, match="time step"):
        BicyclePlant(PARAMETERS).advance(dt)


@pytest.mark.parametrize("command", [(math.nan, 0.0), (1.0, math.inf)])
def test_a_command_that_is_not_finite_leaves_the_last_one(command):
    plant = BicyclePlant(PARAMETERS)
    plant.command(3.0, 0.1)

    with pytest.raises(ValueError, match="not finite"):
        plant.command(*command)

    assert (plant.speed_command, plant.steering_command) == (3.0, 0.1)
