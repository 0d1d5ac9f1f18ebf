"""The stage in real time: pairs of J and R, driven at once, with real processes and sockets."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

from experiments.right_turn.drives import Drive, drive
from experiments.right_turn.systems import BRIDGED, JAUS_ALONE, Setting, generate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from experiments.right_turn.data import Plan, Run

PAIRS_AT_ONCE = 2
"""Pairs of drives at the same time; see docs/experiment.md for what they cost each other."""


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Drives pairs of J and R; writes each run to its folder.

    A quick plan drives one pair.

    Raises:
        RuntimeError: A system does not run.
    """
    for system in (JAUS_ALONE, BRIDGED):
        shutil.rmtree(folder / system.name, ignore_errors=True)
    alone = generate(JAUS_ALONE, folder / "ws" / "J")
    bridged = generate(BRIDGED, folder / "ws" / "R")
    count = 1 if plan.quick else plan.runs
    runs: list[Run] = []
    for first in range(0, count, PAIRS_AT_ONCE):
        numbers = range(first, min(first + PAIRS_AT_ONCE, count))
        tell(f"pairs {first + 1} to {numbers[-1] + 1} of {count}")
        drives = [
            Drive(workspace, f"{number:02d}", Setting(place=2 * (number - first) + side))
            for number in numbers
            for side, workspace in enumerate((alone, bridged))
        ]
        for made in drive(drives, folder / "logs"):
            made.write(made.place(folder))
            runs.append(made)
    summary = {"pairs": count, "at_once": PAIRS_AT_ONCE}
    (folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    return runs
