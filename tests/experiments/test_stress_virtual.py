"""What must hold when something fails in mid-turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from catvehicle.parameters import VehicleParameters
from catvehicle.plant import BicyclePlant, VehicleState

from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions
from experiments.right_turn.record import STANDSTILL
from experiments.right_turn.stress_virtual import bound, cut_off, listened

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("speed", [0.5, 2.0, 4.0, 6.0])
def test_no_vehicle_stops_later_than_its_bound(speed: float) -> None:
    parameters = VehicleParameters()
    plant = BicyclePlant(parameters, VehicleState(v=speed))
    plant.command(parameters.speed_max, 0.0)
    plant.advance(parameters.deadman_timeout)
    plant.command(0.0, 0.0)
    elapsed = parameters.deadman_timeout
    while plant.state.v >= STANDSTILL:
        plant.advance(0.01)
        elapsed += 0.01
    seconds, metres = bound(speed, parameters)

    assert 0.8 * seconds < elapsed <= seconds + 0.01
    assert 0.8 * metres < plant.state.x <= metres


def test_a_vehicle_whose_bridge_is_gone_stops(virtual_workspaces: dict[str, Path]) -> None:
    run, row = cut_off(Conditions(system="R"), Workspace.at(virtual_workspaces["R"]))

    assert row["holds"]
    assert row["speed"] > 3.0
    assert not run.arrived


def test_more_nodes_take_no_more_packets(virtual_workspaces: dict[str, Path]) -> None:
    bridged = Workspace.at(virtual_workspaces["R"])
    few, many = (listened(Conditions(system="R"), bridged, number) for number in (1, 3))

    assert many["packets_per_second"] == few["packets_per_second"]
    assert (few["heard_per_second"], many["heard_per_second"]) == (0.0, 50.0)
