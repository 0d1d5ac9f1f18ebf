"""The controllers know the angle at the time of each speed, and obey the operator."""

import pytest
from catvehicle import SteeringController, StraightArcStraight, VehicleParameters
from catvehicle.logic import AngleSignal, SpeedLogic, SpeedReport, SteeringLogic
from for_each import for_each

PARAMETERS = VehicleParameters()


@for_each("late", [0.0, 0.001, 0.02, 0.039])
def test_an_angle_is_carried_on_to_the_time_of_the_speed(late):
    logic = SteeringLogic(PARAMETERS)
    for index in range(10):
        now = 0.04 * index
        logic.take_angle(-0.3 * now, now)
    step = logic.take_speed(SpeedReport(0, 1.0, now + late))

    assert step.measured_angle == pytest.approx(-0.3 * (now + late))


def test_the_phase_of_the_angle_does_not_matter():
    found = []
    for phase in (0.0, 0.01, 0.03):
        logic = SteeringLogic(PARAMETERS)
        for index in range(75):
            now = 0.04 * index
            logic.take_angle(-0.1 * (now - phase), now - phase)
            step = logic.take_speed(SpeedReport(40 * index, 5.0, now))
        found.append(step.pose)

    for pose in found[1:]:
        assert (pose.x, pose.y) == pytest.approx((found[0].x, found[0].y), abs=0.005)


def test_an_angle_that_no_report_renews_goes_on_for_a_period_only():
    signal = AngleSignal(PARAMETERS)
    signal.take(0.0, 0.0)
    signal.take(0.01, 0.04)

    assert signal.at(0.08) == signal.at(5.0) == pytest.approx(0.02)
    assert signal.at(0.03) == 0.01


@pytest.mark.parametrize("passed", [0.0, 0.001, 0.2])
def test_reports_in_a_burst_or_after_a_silence_say_no_rate(passed):
    signal = AngleSignal(PARAMETERS)
    signal.take(0.0, 1.0)
    signal.take(0.1, 1.0 + passed)

    assert signal.at(1.0 + passed + 0.03) == 0.1


def test_the_tyres_cannot_turn_faster_than_they_can():
    signal = AngleSignal(PARAMETERS)
    signal.take(0.0, 0.0)
    signal.take(0.3, 0.04)

    assert signal.at(0.05) == pytest.approx(0.3 + 0.01 * PARAMETERS.steering_rate_limit)


def test_a_step_integrates_the_pose_and_commands_by_the_law():
    logic = SteeringLogic(PARAMETERS)
    law = SteeringController(PARAMETERS, StraightArcStraight.right_turn(PARAMETERS))
    step = None
    for index in range(200):
        logic.take_angle(-0.05, index * 0.04)
        step = logic.take_speed(SpeedReport(index * 40, 6.0, index * 0.04))

    assert step is not None
    assert step.report.received == 199 * 0.04
    assert step.pose.psi == pytest.approx(199 * 0.04 * 6.0 * -0.05 / PARAMETERS.wheelbase, rel=1e-3)
    assert step.command == law.command(step.pose, 6.0)


def test_without_an_operator_nothing_moves():
    logic = SpeedLogic(PARAMETERS)

    assert logic.command(0.0, 0.0) == 0.0


def test_the_operator_bounds_the_speed():
    logic = SpeedLogic(PARAMETERS)
    logic.take_cruise_speed(3.0)
    assert logic.command(0.0, 0.0) == 3.0

    logic.take_cruise_speed(-1.0)
    assert logic.command(0.0, 0.0) == 0.0


@pytest.mark.parametrize("which", ["measured", "commanded"])
def test_either_tyre_angle_bounds_the_speed(which):
    logic = SpeedLogic(PARAMETERS)
    logic.take_cruise_speed(6.0)
    take = logic.take_measured_angle if which == "measured" else logic.take_commanded_angle
    take(-0.4)

    assert 0.0 < logic.command(0.0, 0.0) < 4.0


def test_behind_the_end_of_the_path_it_stands():
    logic = SpeedLogic(PARAMETERS)
    logic.take_cruise_speed(6.0)

    assert logic.command(37.0, -38.0) == 0.0
