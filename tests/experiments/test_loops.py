"""Drives in virtual time: the generated code of both systems, and what spoils them."""

from __future__ import annotations

import filecmp
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from sweeps import sweep

from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions, Drive, drive

if TYPE_CHECKING:
    from experiments.right_turn.data import Run

ROOT = Path(__file__).resolve().parents[2]

# In a fresh process: same conditions, another hash seed.
AGAIN = """
import sys
from pathlib import Path
sys.path[:0] = [{root!r}]
from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions, drive
conditions = Conditions(system="R", seed=3, sense=dict(loss=0.05, jitter=0.005))
drive(conditions, Workspace.at(Path({workspace!r})), "x").write(Path({folder!r}))
"""


@pytest.fixture(scope="session")
def workspaces(virtual_workspaces: dict[str, Path]) -> dict[str, Workspace]:
    return {system: Workspace.at(folder) for system, folder in virtual_workspaces.items()}


@pytest.mark.parametrize("system", sweep(["R", "J"], every=2))
def test_a_system_drives_the_turn(system: str, workspaces: dict[str, Workspace]) -> None:
    run = drive(Conditions(system=system), workspaces[system], "01")

    assert run.arrived
    assert run.metrics["violation_fraction"] == 0.0
    assert run.metrics["path_error_max"] < 0.35
    assert run.samples[0].t == 0.0
    assert abs(run.samples[0].x) < 1e-4, "the zero of efforts is not quite zero"
    assert run.latency["sense_act"].maximum < 0.003
    assert run.latency["to_vehicle"].count > 100


@pytest.mark.slow
def test_equal_conditions_give_equal_files_in_another_process(
    virtual_workspaces: dict[str, Path], workspaces: dict[str, Workspace], tmp_path: Path
) -> None:
    conditions = Conditions(system="R", seed=3, sense={"loss": 0.05, "jitter": 0.005})
    drive(conditions, workspaces["R"], "x").write(tmp_path / "one")
    code = AGAIN.format(
        root=str(ROOT), workspace=str(virtual_workspaces["R"]), folder=str(tmp_path / "two")
    )
    subprocess.run(
        [sys.executable, "-c", code], check=True, env={"PYTHONHASHSEED": "77"}, timeout=100
    )

    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    _, different, missing = filecmp.cmpfiles(
        tmp_path / "one", tmp_path / "two", names, shallow=False
    )
    assert "samples.csv" in names
    assert (different, missing) == ([], [])


@pytest.mark.slow
def test_another_seed_gives_another_drive(workspaces: dict[str, Workspace]) -> None:
    one, two = (drive(Conditions(system="R", seed=seed), workspaces["R"], "x") for seed in (1, 2))

    assert one.samples != two.samples


@pytest.mark.slow
def test_delay_is_in_the_latencies(workspaces: dict[str, Workspace]) -> None:
    late = {"delay": 0.1}
    run = drive(Conditions(system="R", sense=late, act=late), workspaces["R"], "x")

    assert 0.1 < run.latency["to_controller"].p50 < 0.102
    assert 0.1 < run.latency["to_vehicle"].p50 < 0.102
    assert run.metrics["violation_fraction"] > 0.0, "a control: it must fail"


@pytest.mark.slow
def test_rates_are_those_of_the_model(
    virtual_workspaces: dict[str, Path], workspaces: dict[str, Workspace], tmp_path: Path
) -> None:
    # The code of a model whose rates are a tenth.
    slow = tmp_path / "slow"
    shutil.copytree(virtual_workspaces["R"], slow)
    base = slow / "bridge" / "bridge" / "bridge_base.py"
    text = base.read_text(encoding="utf-8")
    assert text.count("rate=25.0") == 2
    base.write_text(text.replace("rate=25.0", "rate=2.5"), encoding="utf-8")

    as_modelled = reports(drive(Conditions(system="R"), workspaces["R"], "x"))
    tenth = reports(drive(Conditions(system="R"), Workspace.at(slow), "x"))
    alone = reports(drive(Conditions(system="J"), workspaces["J"], "x"))

    assert as_modelled == pytest.approx(25.0, rel=0.1)
    assert alone == pytest.approx(25.0, rel=0.1)
    assert tenth == pytest.approx(2.5, rel=0.1)


def reports(run: Run) -> float:
    """Returns how many reports the vehicle sent in each second of a drive."""
    times = [event.time for event in run.events if event.kind == "report"]
    return (len(times) - 1) / (times[-1] - times[0])


def test_the_vehicle_stops_when_its_network_is_cut(workspaces: dict[str, Workspace]) -> None:
    made = Drive(Conditions(system="R"), workspaces["R"])
    made.start()
    made.run(6.0)
    assert made.record.samples[-1].v > 3.0
    made.vehicle_transport.cut()
    made.run(8.0)
    run = made.finish("cut")

    assert made.record.is_over
    assert not run.arrived
    assert run.samples[-1].v_cmd == 0.0
