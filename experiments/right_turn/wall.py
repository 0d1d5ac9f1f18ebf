"""The stage in real time: pairs of J and R, driven at once, with real processes and sockets."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from catvehicle.parameters import VehicleParameters

from experiments.right_turn.data import Plan, Run
from experiments.right_turn.drives import Drive, drive
from experiments.right_turn.judging import judge
from experiments.right_turn.systems import BRIDGED, JAUS_ALONE, Setting, Workspace, generate

CONTROL_DRIVES = 3
"""Drives of each positive control, all of them at once: they need no ROS."""

CONTROLS = {
    "late": ("J whose commands wait 200 ms, as 100 ms each way", "kinematic", 0.2),
    "understeer": ("J on a plant that understeers", "dynamic", 0.0),
}
"""What must be told from J, or the experiment proves nothing: words, plant, and the delay of
commands (s). The whole delay of the loop is put on the commands: reports come as they do in J."""

PAIRS_AT_ONCE = 2
"""Pairs of drives at the same time, so that ten pairs end within four minutes. What they cost each
other is in the delays that are told: J and R of all pairs share it alike."""


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Drives pairs of J and R; writes each run to its folder.

    A quick plan drives one pair, without positive controls.

    Raises:
        ExperimentError: A system does not run.
    """
    for system in (JAUS_ALONE, BRIDGED):
        shutil.rmtree(folder / system.name, ignore_errors=True)
    alone = generate(JAUS_ALONE, folder / "ws" / "J")
    bridged = generate(BRIDGED, folder / "ws" / "R")
    count = 1 if plan.quick else plan.runs
    runs: list[Run] = []
    load = round(os.getloadavg()[0], 1)
    for first in range(0, count, PAIRS_AT_ONCE):
        numbers = range(first, min(first + PAIRS_AT_ONCE, count))
        tell(f"pairs {first + 1} to {numbers[-1] + 1} of {count}")
        drives = [
            Drive(workspace, f"{number:02d}", Setting(place=2 * (number - first) + side))
            for number in numbers
            for side, workspace in enumerate((alone, bridged))
        ]
        for driven_run in drive(drives, folder / "logs"):
            driven_run.write(driven_run.place(folder))
            runs.append(driven_run)
    summary: dict[str, Any] = {"pairs": count, "at_once": PAIRS_AT_ONCE, "load": load, "claims": []}
    if not plan.quick:
        tell("positive controls")
        good = [finished_run for finished_run in runs if finished_run.system == JAUS_ALONE.name]
        summary["controls"] = controls = _controls(alone, good, folder / "logs")
        summary["claims"] = [
            {
                "text": f"positive control: {control['about']} is distinguished from J",
                "holds": control["differs"],
            }
            for control in controls.values()
        ]
    (folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    return runs


def _controls(alone: Workspace, good: Sequence[Run], logs: Path) -> dict[str, dict[str, Any]]:
    """Drives what must be distinguished from J, and judges it."""
    names = [name for name in CONTROLS for _ in range(CONTROL_DRIVES)]
    drives = [
        Drive(alone, f"{name}_{place}", Setting(place, *CONTROLS[name][1:]))
        for place, name in enumerate(names)
    ]
    runs = drive(drives, logs)
    return {
        name: judged_control(about, good, [run for run in runs if run.name.startswith(name)])
        for name, (about, _, _) in CONTROLS.items()
    }


def judged_control(about: str, good: Sequence[Run], runs: Sequence[Run]) -> dict[str, Any]:
    """Returns what came of a positive control.

    A drive that failed differs for another reason than that of the control, which says nothing
    about the test: then `differs` is None.

    Args:
        about: What it is, in words.
        good: Drives of J.
        runs: Its drives.
    """
    verdict = judge(good, runs, VehicleParameters())
    arrived = sum(run.arrived for run in runs)
    return {
        "about": about,
        "drives": len(runs),
        "arrived": arrived,
        "differs": verdict.moves_differently if arrived == len(runs) else None,
        "by": [row.name for row in verdict.rows if row.differs],
    }
