"""A pair of J and R drives in real time, with real processes."""

import pytest

from experiments.processes import ExperimentError, wait_until
from experiments.right_turn import wall
from experiments.right_turn.data import HOPS, Plan, read_all
from experiments.right_turn.drives import Drive, drive
from experiments.right_turn.systems import JAUS_ALONE, Running, Setting, System, generate

pytestmark = [pytest.mark.live, pytest.mark.slow, pytest.mark.timeout(150)]


def test_both_systems_drive_the_turn(tmp_path):
    """Each hop was measured, and the runs are kept without the logs."""
    runs = wall.run(tmp_path, Plan(quick=True), lambda _: None)
    assert [(run.system, run.arrived) for run in runs] == [("J", True), ("R", True)]
    for run in runs:
        assert run.metrics["path_error_max"] < 1.0
        assert run.samples[-1].psi == pytest.approx(-1.57, abs=0.1)
        assert {hop: run.latency[hop].count > 300 for hop in HOPS} == dict.fromkeys(HOPS, True)
    assert read_all(tmp_path) == runs
    assert not list((tmp_path / "logs").rglob("*.log"))


def test_a_late_command_on_tyres_that_slip_is_another_drive(tmp_path):
    workspace = generate(JAUS_ALONE, tmp_path / "slow")
    setting = Setting(place=3, plant="dynamic", delay=0.2)
    (run,) = drive([Drive(workspace, "late", setting)], tmp_path / "logs")

    assert run.config["plant"] == "dynamic"
    assert run.latency["to_vehicle"].p95 > 0.2
    assert run.metrics["path_error_max"] > 0.6


def test_a_process_that_ends_is_told(tmp_path):
    workspace = generate(JAUS_ALONE, tmp_path / "ended")
    with Running(workspace, Setting(place=4, plant="tank"), tmp_path / "logs") as system:
        system.start_named("vehicle")
        with pytest.raises(
            ExperimentError, match=r"(?s)vehicle in .* has ended:.*'tank' is none of"
        ):
            wait_until(lambda: False, 30.0, system.check)


def test_a_model_with_errors_is_told(tmp_path):
    model = tmp_path / "broken.xmi"
    model.write_text("<broken/>", encoding="utf-8")

    with pytest.raises(ExperimentError, match=r"broken\.xmi cannot be generated"):
        generate(System("J", model, ()), tmp_path / "ws")
