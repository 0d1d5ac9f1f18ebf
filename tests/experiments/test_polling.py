"""A bridge that polls holds what arrives until it looks, and carries the newest only."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from experiments.right_turn.data import Event, Step
from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions, drive
from experiments.right_turn.polling_ros import Held
from experiments.right_turn.record import hops

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def bridged(virtual_workspaces: dict[str, Path]) -> Workspace:
    return Workspace.at(virtual_workspaces["R"])


def test_the_newest_is_delivered_once() -> None:
    got = []
    held = Held(got.append)
    held.look()
    held.put(1)
    assert held.overwritten == 0
    held.put(2)
    held.put(3)
    assert got == []
    held.look()
    held.look()

    assert got == [3]
    assert held.overwritten == 2


def test_polls_delay_the_loop(bridged: Workspace) -> None:
    run = drive(Conditions(polling=20.0), bridged, "x")

    # A report waits for the next look; its answer, which comes after it, for the one after that.
    assert 0.05 < run.latency["sense_act"].p50 < 0.1
    assert run.latency["to_controller"].maximum < 0.052
    assert run.counters["polling.overwritten"] > 50
    assert run.metrics["steering_activity"] > 0.55


def test_a_command_is_not_taken_for_that_of_another_step() -> None:
    events = [Event("report", 0.0, 1000), Event("report", 0.04, 1040), Event("report", 0.08, 1080)]
    steps = [
        Step(1000, 0.01, 0.01, -0.1),
        Step(1040, 0.05, 0.05, -0.1),
        Step(1080, 0.09, 0.09, 0.2),
    ]
    # The command of the first step got lost; that of the second has the same angle.
    events += [Event("command", 0.06, -0.1), Event("command", 0.11, 0.2)]

    found = hops(steps, events)

    assert found["to_controller"] == pytest.approx([0.01, 0.01, 0.01])
    assert found["to_vehicle"] == pytest.approx([0.02])
    assert found["sense_act"] == pytest.approx([0.03])
