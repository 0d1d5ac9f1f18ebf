"""What the sweep accepts and refuses, and where it says that the loop breaks."""

from __future__ import annotations

from dataclasses import asdict, replace

import pytest
from catvehicle.metrics import Sample
from catvehicle.parameters import VehicleParameters

from experiments.right_turn.breaking import breaking_points
from experiments.right_turn.cells import BOUNDS, DELAYS, LOSSES, cells
from experiments.right_turn.data import Plan, Run
from experiments.right_turn.pool import compared, standing
from experiments.right_turn.sweep import claim_on_plant, claims

WITHIN = asdict(BOUNDS)


def row(cell, *, accepted=True, unsafe=0.0):
    most = {"violation_fraction": unsafe}
    return {"name": cell.name, **cell.about, "accepted": accepted, "most": most}


def straight(x, count):
    samples = [Sample(0.01 * n, 0.06 * n, x, 0.0, 6.0, 0.001 * (n % 2), 0, 6) for n in range(count)]
    return Run("J", "1", "virtual", 1, True, samples=samples, metrics={"path_error_max": abs(x)})


def test_a_drive_on_the_bounds_is_accepted() -> None:
    assert BOUNDS.broken(WITHIN) == []


@pytest.mark.parametrize("name", WITHIN)
def test_each_bound_can_be_broken(name: str) -> None:
    assert BOUNDS.broken(WITHIN | {name: WITHIN[name] + 0.001}) == [name]
    assert BOUNDS.broken({key: value for key, value in WITHIN.items() if key != name}) == [name]


def test_the_gap_of_two_drives_is_told() -> None:
    found = compared(straight(0.0, 100), straight(0.25, 100))

    assert found["gap_position"] == pytest.approx(0.25)
    assert found["closeness_100ms"] == pytest.approx(0.25)
    assert found["path_error_excess"] == pytest.approx(0.25)
    assert found["activity_ratio"] == 1.0


def test_a_vehicle_stands_where_its_drive_has_ended() -> None:
    longer = standing(straight(0.0, 3).samples, 5)

    assert [each.t for each in longer] == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])
    assert longer[-1].x == longer[2].x


def test_bisection_ends_beside_the_place_where_it_breaks() -> None:
    def drive(wanted):
        found = []
        for cell in wanted:
            late = max(
                link.get("delay", 0.0) for link in (cell.conditions.sense, cell.conditions.act)
            )
            lost = cell.conditions.act.get("loss", 0.0)
            unsafe = 0.1 if late > 0.061 or lost > 0.133 else 0.0
            accepted = late <= 0.0173 and lost <= 0.031
            found.append(row(cell, accepted=accepted, unsafe=unsafe))
        return found

    limits = {
        (each["way"], each["criterion"]): (each["holds"], each["breaks"])
        for each in breaking_points(drive(cells(Plan())), drive)
    }

    for way in ("sense", "act", "both"):
        for criterion, place in (("accepted", 17.3), ("safe", 61.0)):
            holds, breaks = limits[way, criterion]
            assert holds <= place < breaks <= holds + 1.0
    for criterion, place in (("accepted", 3.1), ("safe", 13.3)):
        holds, breaks = limits["loss", criterion]
        assert holds <= place < breaks <= holds + 1.0


def test_what_never_breaks_has_no_breaking_point() -> None:
    rows = [row(cell) for cell in cells(Plan())]
    for each in breaking_points(rows, lambda wanted: pytest.fail(f"{wanted} need no drive")):
        assert each["breaks"] is None
        assert each["holds"] == (LOSSES if each["way"] == "loss" else DELAYS)[-1]


def test_a_sweep_that_accepts_everything_claims_nothing() -> None:
    rows = [row(cell) for cell in cells(Plan(quick=True))]

    assert [claim["holds"] for claim in claims(rows)] == [True, True, False, False]


def test_no_two_cells_have_one_name() -> None:
    names = [cell.name for cell in cells(Plan())]
    assert len(names) == len(set(names))


@pytest.mark.slow
def test_a_mass_that_the_tyres_do_not_fit_is_seen() -> None:
    parameters = VehicleParameters()

    assert claim_on_plant(parameters)["holds"]
    assert not claim_on_plant(replace(parameters, mass=2883.2))["holds"]
    assert not claim_on_plant(replace(parameters, rear_axle_distance=1.2))["holds"]
