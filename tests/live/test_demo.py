"""The demonstration drives the turn with real processes, as `make demo` does."""

import os
import re
import struct
import sys
from pathlib import Path

import pytest
from for_each import for_each
from scripts import succeeded

DEMO = Path(__file__).resolve().parents[2] / "models" / "catvehicle" / "demo.py"
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(150)]


@pytest.fixture
def run(tmp_path: Path) -> tuple[Path, str]:
    """Runs the demonstration; returns its folder and what it printed."""
    folder = tmp_path / "out"
    result = succeeded(
        [sys.executable, str(DEMO), str(folder)],
        env={**os.environ, "ROS_DOMAIN_ID": "88"},
        cwd=folder.parent,
        timeout=120,
    )
    return folder, result.stdout


def value(table: str, name: str) -> float:
    """Returns the first number behind a name in the printed tables."""
    found = re.search(rf"^{re.escape(name)} +([-\d.e]+)", table, re.MULTILINE)
    assert found, f"no row '{name}'"
    return float(found[1])


def arrives_and_judges(run: tuple[Path, str]) -> None:
    folder, printed = run
    assert "arrived at" in printed
    assert (folder / "table.txt").read_text(encoding="utf-8") in printed


def follows_the_path(run: tuple[Path, str]) -> None:
    # A wrong sign of yaw, tyre angle or y anywhere leaves the path by tens of metres.
    table = (run[0] / "table.txt").read_text(encoding="utf-8")
    assert value(table, "path error, largest") < 1.0


def every_connection_carried_messages(run: tuple[Path, str]) -> None:
    table = (run[0] / "table.txt").read_text(encoding="utf-8")
    for name in (
        "odometry",
        "steering_angle",
        "pose",
        "steering_command",
        "speed_command",
        "cruise_speed",
        "estimated_pose",
    ):
        assert value(table, name) > 10, name


def latency_was_measured_both_ways(run: tuple[Path, str]) -> None:
    table = (run[0] / "table.txt").read_text(encoding="utf-8")
    for name in ("vehicle -> bridge -> ROS", "ROS -> bridge -> vehicle", "whole loop"):
        assert value(table, name) > 100, name


def turns_right(run: tuple[Path, str]) -> None:
    rows = (run[0] / "logs" / "vehicle.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "t,x,y,psi,v,delta,delta_cmd,v_cmd"
    last = dict(zip(rows[0].split(","), map(float, rows[-1].split(",")), strict=True))
    assert last["y"] < -30.0
    assert last["psi"] == pytest.approx(-1.5708, abs=0.1)


def ros_saw_the_turn_in_its_own_axes(run: tuple[Path, str]) -> None:
    rows = (run[0] / "logs" / "logger.csv").read_text(encoding="utf-8").splitlines()
    poses = [row.split(",") for row in rows if row.startswith("pose,")]
    assert float(poses[-1][3]) < -30.0
    yaw_rates = [float(row.split(",")[3]) for row in rows if row.startswith("odometry,")]
    assert min(yaw_rates) < -0.2
    assert max(yaw_rates) < 0.1


def processes_ended_without_a_fault(run: tuple[Path, str]) -> None:
    output = (run[0] / "logs" / "output.txt").read_text(encoding="utf-8")
    assert "Traceback" not in output
    assert len(re.findall(r"drops: ", output)) == 3  # vehicle, operator, bridge


def draws_a_picture(run: tuple[Path, str]) -> None:
    data = (run[0] / "turn.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", data[16:24])
    assert (width, height) > (800, 400)


def a_drive_that_does_not_arrive_has_failed(run: tuple[Path, str]) -> None:
    logs = run[0] / "short"
    logs.mkdir()
    shown = f"demo.reason_of_failure(demo.drive({run[0] / 'ws'!r}, {logs!r}, 3), 3)"
    code = f"from pathlib import *; import demo; print({shown})"
    result = succeeded([sys.executable, "-c", code], cwd=DEMO.parent)
    assert "arrived at" not in result.stdout
    reason = "the vehicle did not arrive within 3 s; its last word: "
    assert result.stdout.splitlines()[-1].startswith(reason)


# One test: of several, each worker that has one of them would drive.
HOLDING = [
    arrives_and_judges,
    follows_the_path,
    every_connection_carried_messages,
    latency_was_measured_both_ways,
    turns_right,
    ros_saw_the_turn_in_its_own_axes,
    processes_ended_without_a_fault,
    draws_a_picture,
    a_drive_that_does_not_arrive_has_failed,
]


@for_each("holds", HOLDING, ids=lambda holds: holds.__name__)
def test_the_demonstration(holds, run):
    holds(run)
