"""Drives along lists in virtual time: J and R are alike, and each mistake is seen."""

from __future__ import annotations

import pytest
from sweeps import sweep

from experiments.right_turn.generated import Workspace
from experiments.waypoints.controls import CONTROLS, LATE
from experiments.waypoints.drives import EMERGENCY, LOST, WHOLE
from experiments.waypoints.equivalence import bound, path_gap, path_of
from experiments.waypoints.systems import SYSTEMS, generated
from experiments.waypoints.virtual import Conditions, VirtualDrive

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    folder = tmp_path_factory.mktemp("waypoints")
    return {name: Workspace.at(generated(name, folder / name)) for name in SYSTEMS}


@pytest.fixture
def drive(places):
    def run(conditions, kind=WHOLE):
        made = VirtualDrive(kind, conditions, places[conditions.system])
        return made.run(), path_of(made.record.truth)

    return run


def broken(result):
    return [text for text, holds in result.claims.items() if not holds]


@pytest.mark.slow
def test_both_do_what_is_required_on_the_same_path(drive) -> None:
    (alone, path), (bridged, other) = drive(Conditions("J")), drive(Conditions("R"))
    assert broken(alone) == broken(bridged) == []
    assert alone.active == bridged.active == [*range(1, len(WHOLE.waypoints) + 1), 0]
    assert path_gap(path, other) <= bound()
    assert len(path) > 900


@pytest.mark.parametrize("kind", [EMERGENCY, LOST], ids=lambda each: each.name)
@pytest.mark.parametrize("system", ["J", "R"])
def test_both_stop(drive, system, kind) -> None:
    result, _ = drive(Conditions(system), kind)
    assert broken(result) == []


REASONS = {
    "sign": "each waypoint is passed",
    "axes": "each waypoint is passed",
    "unit": "each waypoint is passed",
    "frame": "each waypoint is passed",
    "poses": "where the robot is said to be",
    "cancel": "an emergency stops the robot",
    "stop": "without its operator, the robot stops",
}


@pytest.mark.parametrize("name", sweep(CONTROLS, every=4))
def test_a_mistake_is_refused(drive, name) -> None:
    control = CONTROLS[name]
    result, _ = drive(control.conditions, control.drive)
    assert any(text.startswith(REASONS[name]) for text in broken(result))


def test_late_odometry_is_told_by_the_path(drive) -> None:
    (_, path), (late, other) = drive(Conditions("J")), drive(LATE)
    assert broken(late) == []
    assert path_gap(path, other) > bound()


def test_paths_are_apart_by_their_farthest_point() -> None:
    straight = [(at / 10, 0.0) for at in range(11)]
    assert path_gap(straight, straight[::5]) == 0.0  # samples of the same path
    beside = [(x, 0.3 if x == 0.5 else 0.0) for x, _ in straight]
    assert path_gap(straight, beside) == pytest.approx(0.3, abs=0.01)
    assert path_gap(straight, straight[:6]) == pytest.approx(0.5)
    assert path_gap(straight, []) == float("inf")
