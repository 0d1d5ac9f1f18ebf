"""The plant on a clock that the test moves."""

import pytest
from catvehicle.metrics import Sample
from catvehicle.parameters import VehicleParameters
from catvehicle.path import Pose
from catvehicle.plant import BicyclePlant
from catvehicle.realtime import RealTimePlant


class Clock:
    """Monotonic seconds, moved by hand."""

    def __init__(self) -> None:
        self.time = 100.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_follows_the_clock(clock):
    plant = RealTimePlant(VehicleParameters(deadman_timeout=10.0), clock)
    plant.command_speed(2.0)
    clock.time += 1.0
    reference = BicyclePlant(VehicleParameters())
    reference.command(2.0, 0.0)
    assert plant.state().v == pytest.approx(reference.advance(1.0).v)
    assert plant.sample().t == pytest.approx(1.0)


def test_dead_man_acts_at_its_instant_even_when_asked_later(clock):
    parameters = VehicleParameters(deadman_timeout=0.2)
    plant = RealTimePlant(parameters, clock)
    plant.command_speed(5.0)
    clock.time += 3.0
    reference = BicyclePlant(parameters)
    reference.command(5.0, 0.0)
    reference.advance(0.2)
    reference.command(0.0, 0.0)
    assert plant.state().v == pytest.approx(reference.advance(2.8).v)
    assert plant.sample().v_cmd == 0.0


def test_dead_man_keeps_the_tyre_angle(clock):
    plant = RealTimePlant(VehicleParameters(), clock)
    plant.command_speed(5.0)
    plant.command_steering(-0.2)
    clock.time += 5.0
    assert plant.sample().delta_cmd == pytest.approx(-0.2)
    assert plant.state().delta == pytest.approx(-0.2, abs=1e-3)


def test_renewed_commands_keep_it_going(clock):
    plant = RealTimePlant(VehicleParameters(), clock)
    for _ in range(50):
        plant.command_speed(3.0)
        clock.time += 0.1
    assert plant.state().v > 2.5


def test_place_keeps_motion_and_commands(clock):
    plant = RealTimePlant(VehicleParameters(deadman_timeout=10.0), clock)
    plant.command_speed(3.0)
    clock.time += 2.0
    before = plant.state()
    plant.place(Pose(10.0, -5.0, 1.0))
    placed = plant.state()
    assert (placed.x, placed.y, placed.psi) == (10.0, -5.0, 1.0)
    assert placed.v == before.v
    clock.time += 2.0
    assert plant.state().v > before.v


def test_stop(clock):
    plant = RealTimePlant(VehicleParameters(), clock)
    plant.command_speed(3.0)
    clock.time += 0.1
    plant.stop()
    clock.time += 10.0
    assert plant.state().v == pytest.approx(0.0, abs=1e-3)


def test_a_vehicle_that_stood_for_a_year_answers_at_once(clock):
    plant = RealTimePlant(VehicleParameters(), clock)
    plant.command_speed(3.0)
    clock.time += 60.0
    stopped = plant.state()
    clock.time += 365 * 86400.0  # a step each millisecond would outlast the limit of the test
    assert plant.state() == stopped
    assert stopped.v == 0.0
    plant.command_speed(3.0)
    clock.time += 0.1
    assert plant.state().v > 0.0


def test_the_truth_is_recorded_every_hundredth_second(clock):
    rows: list[Sample] = []
    parameters = VehicleParameters()
    plant = RealTimePlant(parameters, clock, record=rows.append)
    plant.command_speed(5.0)
    clock.time += 0.3033
    plant.command_speed(5.0)
    clock.time += 1.0
    plant.state()

    assert [round(row.t * 100, 6) for row in rows] == list(range(131))
    # The dead man acts between two rows, at its instant.
    assert [row.v_cmd for row in rows[18:23] if row is not rows[20]] == [5.0, 5.0, 0.0, 0.0]
    assert rows[31].v_cmd == 5.0
    assert rows[-1].v_cmd == 0.0
    unrecorded = RealTimePlant(parameters, clock)
    assert unrecorded.sample().v == 0.0


def test_recording_does_not_change_the_drive(clock):
    rows: list[Sample] = []
    plants = [
        RealTimePlant(VehicleParameters(), clock, record=record) for record in (rows.append, None)
    ]
    for _ in range(100):
        clock.time += 0.0173
        for plant in plants:
            plant.command_speed(4.0)
            plant.command_steering(-0.2)
    first, second = (plant.state() for plant in plants)

    assert (first.x, first.y, first.psi) == pytest.approx(
        (second.x, second.y, second.psi), abs=1e-6
    )
