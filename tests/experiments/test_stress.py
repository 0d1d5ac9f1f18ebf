"""What is killed in mid-turn: the bounds that vehicles are held to, and real processes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from catvehicle import BicyclePlant, Sample, VehicleParameters, VehicleState
from catvehicle.realtime import RealTimePlant

from experiments.right_turn import stress
from experiments.right_turn.data import Plan
from experiments.right_turn.stress import braking_distance, claims, stopping

if TYPE_CHECKING:
    from pathlib import Path

PARAMETERS = VehicleParameters()


def stopped(speed: float, timeout: float = PARAMETERS.deadman_timeout) -> dict[str, float]:
    """How a vehicle stops at a speed (m/s) whose dead-man switch takes a time (s)."""
    now = [0.0]
    rows: list[Sample] = []
    plant = BicyclePlant(PARAMETERS, VehicleState(v=speed, delta=-0.2))
    switch = VehicleParameters(deadman_timeout=timeout)
    vehicle = RealTimePlant(switch, lambda: now[0], plant, rows.append)
    now[0] = 0.005
    vehicle.command_speed(speed + 1.0)
    now[0] = 15.0
    vehicle.state()
    return stopping(rows, 0.005, PARAMETERS)


@pytest.mark.parametrize("speed", [0.5, 2.0, 4.0, 6.0])
def test_a_vehicle_with_its_dead_man_switch_stops_within_the_bounds(speed: float) -> None:
    found = stopped(speed)

    assert found["silence"] == pytest.approx(PARAMETERS.deadman_timeout, abs=0.011)
    assert found["silence"] <= found["silence_bound"]
    # The bound is no idle one either.
    assert 0.5 * found["distance_bound"] < found["distance"] <= found["distance_bound"]


def test_a_switch_that_takes_longer_breaks_the_bounds() -> None:
    found = stopped(5.0, timeout=0.5)

    assert found["silence"] > found["silence_bound"]
    assert found["distance"] > found["distance_bound"]


def test_a_vehicle_that_drives_on_has_no_way_to_rest() -> None:
    found = stopped(5.0, timeout=100.0)

    assert found["silence"] == found["distance"] == float("inf")


def test_braking_distance_of_a_vehicle_that_brakes_as_its_lag_says() -> None:
    # From 1 m/s braking never saturates: 0.22 s at 1.44 m/s at most, then speed times lag.
    assert braking_distance(1.0, PARAMETERS) == pytest.approx(1.44 * 0.22 + 1.44 * 0.667)


GOOD = {"silence": 0.2, "silence_bound": 0.22, "distance": 4.0, "distance_bound": 5.0}


def held(**summary: object) -> list[bool]:
    return [claim["holds"] for claim in claims({"killed": {}, **summary})]


def test_claims() -> None:
    assert held(killed={"bridge": GOOD, "controller": GOOD | {"silence": 0.3}}) == [True, False]
    assert held(killed={"bridge": GOOD | {"distance": 5.1}}) == [False]
    assert held(restarted={"arrived": False}) == [False]


@pytest.mark.parametrize(
    ("rates", "heard", "holds"),
    [((25.0, 25.2), 24.0, True), ((25.0, 100.0), 24.0, False), ((25.0, 25.0), 0.0, False)],
)
def test_the_claim_on_many_nodes(rates: tuple[float, ...], heard: float, holds: bool) -> None:
    counts = [{"reports_per_second": rate, "heard_least": heard} for rate in rates]

    assert held(listeners=counts) == [holds]


@pytest.mark.live
@pytest.mark.slow
@pytest.mark.timeout(200)
def test_what_is_killed_in_mid_turn_stops_the_vehicle(tmp_path: Path) -> None:
    runs = stress.run(tmp_path, Plan(quick=True), lambda _: None)

    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert [claim["holds"] for claim in summary["claims"]] == [True, True], summary
    assert [(run.name, run.arrived) for run in runs] == [
        ("bridge_killed", False),
        ("controller_killed", False),
    ]
    assert all(-1.6 < run.samples[-1].psi < -0.6 for run in runs)
