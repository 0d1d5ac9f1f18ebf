"""The controllers step on whole states, in whatever order halves come, and obey the operator."""

from __future__ import annotations

import pytest
from catvehicle import SteeringController, StraightArcStraight, VehicleParameters
from catvehicle.logic import SpeedLogic, SpeedReport, SteeringLogic

PARAMETERS = VehicleParameters()


def steps(*messages: tuple[str, float, float]) -> list[tuple[int, float]]:
    """Feed reports, each with the time at which it comes; return time stamp and angle of steps."""
    logic = SteeringLogic(PARAMETERS)
    made = [
        logic.take_angle(value, received)
        if kind == "angle"
        else logic.take_speed(SpeedReport(int(value), 1.0, received))
        for kind, value, received in messages
    ]
    return [(step.report.stamp_ms, step.measured_angle) for step in made if step is not None]


@pytest.mark.parametrize("first", ["speed", "angle"])
def test_a_speed_goes_with_the_angle_of_its_own_period(first: str) -> None:
    halves = [
        [("speed", 1, 0.0), ("angle", 0.1, 0.001)],
        [("speed", 2, 0.04), ("angle", 0.2, 0.041)],
    ]
    if first == "angle":
        halves = [
            [("angle", 0.1, 0.0), ("speed", 1, 0.001)],
            [("angle", 0.2, 0.04), ("speed", 2, 0.041)],
        ]

    assert steps(*halves[0], *halves[1]) == [(1, 0.1), (2, 0.2)]


def test_an_angle_that_came_before_the_first_speed_is_not_taken_for_ever_a_period_late() -> None:
    ahead = ("angle", 0.0, 0.008)
    periods = [
        [("speed", each, 0.04 * each), ("angle", 0.1 * each, 0.04 * each + 0.008)]
        for each in (1, 2, 3)
    ]

    made = steps(ahead, *(message for period in periods for message in period))

    assert made == [(1, 0.1), (2, 0.2), (3, pytest.approx(0.3))]


def test_a_lost_angle_holds_nothing_up() -> None:
    received = [
        ("speed", 1, 0.0),
        ("angle", 0.1, 0.001),
        ("speed", 2, 0.04),
        ("speed", 3, 0.08),
        ("angle", 0.3, 0.081),
    ]
    assert steps(*received) == [(1, 0.1), (2, 0.1), (3, 0.3)]


def test_the_angle_of_the_next_period_does_not_stand_for_one_that_was_lost() -> None:
    received = [
        ("angle", 0.1, 0.0),
        ("speed", 1, 0.001),
        ("speed", 2, 0.041),
        ("angle", 0.3, 0.08),
        ("speed", 3, 0.081),
    ]
    assert steps(*received) == [(1, 0.1), (2, 0.1), (3, 0.3)]


def test_a_lost_speed_makes_no_step() -> None:
    assert steps(("angle", 0.1, 0.0), ("angle", 0.2, 0.04), ("speed", 2, 0.041)) == [(2, 0.2)]


def test_a_step_integrates_the_pose_and_commands_by_the_law() -> None:
    logic = SteeringLogic(PARAMETERS)
    law = SteeringController(PARAMETERS, StraightArcStraight.right_turn(PARAMETERS))
    step = None
    for index in range(200):
        assert logic.take_speed(SpeedReport(index * 40, 6.0, index * 0.04)) is None
        step = logic.take_angle(-0.05, index * 0.04 + 0.001)

    assert step is not None
    assert step.report.received == 199 * 0.04
    assert step.pose.psi == pytest.approx(199 * 0.04 * 6.0 * -0.05 / PARAMETERS.wheelbase, rel=1e-3)
    assert step.command == law.command(step.pose, 6.0)


def test_without_an_operator_nothing_moves() -> None:
    logic = SpeedLogic(PARAMETERS)

    assert logic.command(0.0, 0.0) == 0.0


def test_the_operator_bounds_the_speed() -> None:
    logic = SpeedLogic(PARAMETERS)
    logic.take_cruise_speed(3.0)
    assert logic.command(0.0, 0.0) == 3.0

    logic.take_cruise_speed(-1.0)
    assert logic.command(0.0, 0.0) == 0.0


@pytest.mark.parametrize("which", ["measured", "commanded"])
def test_either_tyre_angle_bounds_the_speed(which: str) -> None:
    logic = SpeedLogic(PARAMETERS)
    logic.take_cruise_speed(6.0)
    take = logic.take_measured_angle if which == "measured" else logic.take_commanded_angle
    take(-0.4)

    assert 0.0 < logic.command(0.0, 0.0) < 4.0


def test_behind_the_end_of_the_path_it_stands() -> None:
    logic = SpeedLogic(PARAMETERS)
    logic.take_cruise_speed(6.0)

    assert logic.command(37.0, -38.0) == 0.0
