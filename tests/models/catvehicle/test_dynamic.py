"""The dynamic bicycle against closed forms, and the choice of plants by name."""

import math

import pytest
from catvehicle import BicyclePlant, VehicleParameters, VehicleState
from catvehicle.dynamic import DynamicPlant
from catvehicle.plants import (
    DELAY_VARIABLE,
    PLANT_VARIABLE,
    delay_from_environment,
    plant_from_environment,
    plant_of,
)

PARAMETERS = VehicleParameters()


def settled(speed: float, angle: float, **changed: float) -> DynamicPlant:
    """Returns a plant after five seconds at a speed (m/s) and a tyre angle (rad)."""
    plant = DynamicPlant(VehicleParameters(**changed), VehicleState(v=speed, delta=angle))
    plant.command(speed, angle)
    plant.advance(5.0)
    return plant


@pytest.mark.parametrize("speed", [2.0, 4.0, 6.0])
def test_a_steady_turn_understeers_as_the_stiffnesses_say(speed):
    behind = PARAMETERS.rear_axle_distance
    ahead = PARAMETERS.wheelbase - behind
    coefficient = (
        PARAMETERS.mass
        / PARAMETERS.wheelbase**2
        * (
            behind / PARAMETERS.front_cornering_stiffness
            - ahead / PARAMETERS.rear_cornering_stiffness
        )
    )
    assert coefficient == pytest.approx(0.0015, rel=0.01)

    expected = speed * -0.02 / (PARAMETERS.wheelbase * (1 + coefficient * speed**2))
    assert settled(speed, -0.02).yaw_rate == pytest.approx(expected, rel=2e-3)


def test_stiff_tyres_are_the_kinematic_bicycle():
    plant = settled(
        4.0,
        -0.2,
        front_cornering_stiffness=9e5,
        rear_cornering_stiffness=9e5,
        rear_axle_distance=1.31,
    )
    reference = BicyclePlant(PARAMETERS, VehicleState(v=4.0, delta=-0.2))

    assert plant.yaw_rate == pytest.approx(reference.yaw_rate, rel=0.01)


def test_at_a_crawl_the_tyres_roll():
    plant, reference = DynamicPlant(PARAMETERS), BicyclePlant(PARAMETERS)
    for model in (plant, reference):
        model.command(0.8, -0.3)
        model.advance(6.0)

    assert plant.yaw_rate == pytest.approx(reference.yaw_rate, rel=1e-3)
    assert plant.state.y == pytest.approx(reference.state.y, abs=0.05)


def test_it_turns_right_and_comes_to_rest():
    plant = DynamicPlant(PARAMETERS)
    plant.command(6.0, -0.2)
    assert plant.advance(4.0).psi < -0.5
    plant.command(0.0, 0.0)
    plant.advance(20.0)
    rested = plant.state

    assert plant.advance(5.0) == rested
    assert rested.v == 0.0
    assert plant.yaw_rate == pytest.approx(0.0, abs=1e-6)
    assert all(map(math.isfinite, (rested.x, rested.y, rested.psi)))


def test_plants_by_name(monkeypatch):
    monkeypatch.delenv(PLANT_VARIABLE, raising=False)
    assert type(plant_from_environment(PARAMETERS)) is BicyclePlant
    monkeypatch.setenv(PLANT_VARIABLE, "dynamic")
    assert type(plant_from_environment(PARAMETERS)) is DynamicPlant
    with pytest.raises(ValueError, match="CATVEHICLE_PLANT: 'tank' is none of kinematic, under"):
        plant_of("tank", PARAMETERS)


def test_the_plant_that_understeers_turns_less():
    yaw = {}
    for name in ("kinematic", "understeer"):
        plant = plant_of(name, PARAMETERS)
        plant.command(6.0, -0.2)
        yaw[name] = plant.advance(5.0).psi

    assert yaw["kinematic"] < yaw["understeer"] < 0.0


@pytest.mark.parametrize("text", ["soon", "-1", "nan", "60"])
def test_a_delay_that_is_none_is_refused(monkeypatch, text):
    monkeypatch.setenv(DELAY_VARIABLE, text)

    with pytest.raises(ValueError, match="CATVEHICLE_DELAY"):
        delay_from_environment()


def test_the_delay_is_read(monkeypatch):
    monkeypatch.delenv(DELAY_VARIABLE, raising=False)
    assert delay_from_environment() == 0.0
    monkeypatch.setenv(DELAY_VARIABLE, "0.1")
    assert delay_from_environment() == 0.1
