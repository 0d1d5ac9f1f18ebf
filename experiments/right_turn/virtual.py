"""The stage in virtual time: J and R on one simulated clock, driven with several seeds."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions, drive
from experiments.right_turn.systems import BRIDGED, JAUS_ALONE, generate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from experiments.right_turn.data import Plan, Run

SEEDS = (1, 2, 3)
"""Seeds of the phases between the processes, and of what the network does."""


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Drives both systems; writes each run to its folder.

    A quick plan has one seed.
    """
    runs: list[Run] = []
    for system in (JAUS_ALONE, BRIDGED):
        shutil.rmtree(folder / system.name, ignore_errors=True)
        place = folder / "ws" / system.name
        generate(system, place)
        workspace = Workspace.at(place)
        for seed in SEEDS[:1] if plan.quick else SEEDS:
            tell(f"{system.name}, seed {seed}")
            made = drive(Conditions(system.name, seed), workspace, f"{seed:02d}")
            made.write(made.place(folder))
            runs.append(made)
    claims = [
        {
            "text": f"virtual time: each drive of {system.name} arrives in the safe region",
            "holds": all(
                made.arrived and made.metrics["violation_fraction"] == 0
                for made in runs
                if made.system == system.name
            ),
        }
        for system in (JAUS_ALONE, BRIDGED)
    ]
    text = json.dumps({"claims": claims}, indent=2) + "\n"
    (folder / "summary.json").write_text(text, encoding="utf-8")
    return runs
