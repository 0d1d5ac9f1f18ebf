"""How much delay, jitter and loss the right turn bears: many drives in virtual time.

Each cell is R under some conditions, driven with several seeds and compared with J under nominal
conditions and the same seed; where the rate of the reports differs, with J at that rate. A cell is
accepted when its worst drive keeps every bound. Everything is written to `summary.json`.
"""

from __future__ import annotations

import json
import math
import shutil
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from catvehicle.parameters import VehicleParameters
from catvehicle.plants import UNDERSTEER, plant_of

from experiments.right_turn.breaking import breaking_points
from experiments.right_turn.cells import BOUNDS, Cell, cells
from experiments.right_turn.loops import HOP, Conditions
from experiments.right_turn.pool import Pool, Task
from experiments.right_turn.stages import digest
from experiments.right_turn.systems import BRIDGED, JAUS_ALONE, generate

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from experiments.right_turn.data import Plan, Run


WIDE = 0.01
"""Tyre angle in rad of a turn so wide that the tyres' force is in proportion to it."""

SETTLED = 20.0
"""Seconds after which speed, tyre angle and slip have settled."""


def workspaces(folder: Path) -> dict[str, Path]:
    """Generates both systems, or finds them as another stage has generated them.

    Args:
        folder: Folder of the stage; what is generated stands beside it.

    Returns:
        The folder of each system by its name.
    """
    place = folder.parent / "virtual_workspaces"
    stamp, present = place / "digest", digest()
    systems = (JAUS_ALONE, BRIDGED)
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != present:
        for system in systems:
            generate(system, place / system.name)
        stamp.write_text(present, encoding="utf-8")
    return {system.name: place / system.name for system in systems}


class Sweep:
    """Drives cells and gathers what comes of them.

    Attributes:
        kept: Runs that were written.
    """

    def __init__(self, folder: Path, pool: Pool, tell: Callable[[str], None]) -> None:
        """Generate the workspaces, and remove what an earlier sweep has left.

        Args:
            folder: Folder of the stage.
            pool: Drives.
            tell: Told how far it is.
        """
        self.kept: list[Run] = []
        self._folder = folder
        self._pool = pool
        self._tell = tell
        tell("generating both systems")
        self._workspaces = workspaces(folder)
        for former in folder.iterdir():
            if former.is_dir():
                shutil.rmtree(former)
        self._driven = 0
        self._references: set[tuple[float, int]] = set()

    def drive(self, wanted: Sequence[Cell]) -> list[dict[str, Any]]:
        """Drives cells and returns a row for each."""
        needed = {
            (cell.conditions.rate, seed + cell.other_seed)
            for cell in wanted
            for seed in cell.drives
        }
        self._drive([self._task_of_reference(*each) for each in sorted(needed - self._references)])
        self._references |= needed
        tasks = [self._task(cell, seed) for cell in wanted for seed in cell.drives]
        runs = iter(self._drive(tasks))
        return [_row(cell, [next(runs) for _ in cell.drives]) for cell in wanted]

    def _drive(self, tasks: Sequence[Task]) -> list[Run]:
        def done() -> None:
            self._driven += 1
            self._tell(f"{self._driven} drives done")

        runs = self._pool.drive(tasks, done)
        self.kept += [run for run, task in zip(runs, tasks, strict=True) if task.folder]
        return runs

    def _task_of_reference(self, rate: float, seed: int) -> Task:
        conditions = Conditions(system="J", rate=rate, seed=seed)
        place = self._place_of_reference(rate, seed)
        return Task(place.name, conditions, self._workspaces["J"], folder=place)

    def _place_of_reference(self, rate: float, seed: int) -> Path:
        name = f"rate-{rate:g}" if rate else "modelled"
        return self._folder / "J" / f"{name}-{seed:02}"

    def _task(self, cell: Cell, seed: int) -> Task:
        conditions = replace(cell.conditions, seed=seed)
        name = f"{cell.name}-{seed:02}"
        # Of all the drives that differ by their seed only, the first can be looked at.
        is_kept = cell.is_kept or (seed == 1 and cell.about["group"] != "search")
        return Task(
            name,
            conditions,
            self._workspaces[conditions.system],
            cell.system,
            self._place_of_reference(conditions.rate, seed + cell.other_seed),
            self._folder / cell.system / name if is_kept else None,
        )


def _row(cell: Cell, runs: Sequence[Run]) -> dict[str, Any]:
    """Returns what came of a cell: its worst drive, and which bounds it breaks."""
    names = {name for run in runs for name in run.metrics}
    most = {name: max(run.metrics.get(name, math.inf) for run in runs) for name in names}
    least = {name: min(run.metrics.get(name, -math.inf) for run in runs) for name in names}
    broken = BOUNDS.broken(most)
    if not all(run.arrived for run in runs):
        broken.append("arrived")
    return {
        "name": cell.name,
        "system": cell.system,
        **cell.about,
        "drives": len(runs),
        "arrived": sum(run.arrived for run in runs),
        "accepted": not broken,
        "broken": broken,
        "most": {name: rounded(value) for name, value in sorted(most.items())},
        "least_speed_margin": rounded(least.get("least_speed_margin", math.nan)),
    }


def rounded(value: float) -> float | None:
    """Returns a value with four digits, as JSON has it: None for what is not finite."""
    return float(f"{value:.4g}") if math.isfinite(value) else None


def store(folder: Path, summary: Mapping[str, Any]) -> None:
    """Writes the summary of a stage."""
    text = json.dumps(summary, indent=1, sort_keys=True, allow_nan=False)
    (folder / "summary.json").write_text(text + "\n", encoding="utf-8")


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Drives all cells, looks for the breaking points and writes `summary.json`.

    Args:
        folder: Folder of the stage.
        plan: How much is driven.
        tell: Told how far it is.

    Returns:
        The runs that were written: those of J, and the first of each cell.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with Pool() as pool:
        sweep = Sweep(folder, pool, tell)
        rows = sweep.drive(cells(plan))
        limits = [] if plan.quick else breaking_points(rows, sweep.drive)
    summary = {
        "bounds": asdict(BOUNDS),
        "hop": HOP,
        "cells": rows,
        "limits": limits,
        "claims": [*claims(rows), claim_on_plant(VehicleParameters())],
    }
    store(folder, summary)
    return sweep.kept


def claims(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Returns what must hold, so that the sweep means something: it accepts, and it refuses."""
    accepted = {row["name"]: row["accepted"] for row in rows}
    must = {
        "nominal": ("virtual time: R is accepted beside J", True),
        "null": ("virtual time: J is accepted beside J with other seeds", True),
        "late": ("virtual time: 100 ms each way are refused", False),
        "understeer": ("virtual time: a plant that understeers is refused", False),
    }
    return [
        {"text": text, "holds": accepted[name] == wanted} for name, (text, wanted) in must.items()
    ]


def claim_on_plant(parameters: VehicleParameters) -> dict[str, Any]:
    """Returns the claim that the tyres slip as those of the public simulator.

    It is what mass, axles and stiffnesses give together. Only drives that must differ from J make
    use of them, so that no drive shows that they are wrong.

    Args:
        parameters: Those of the vehicle.
    """
    text = f"the plant whose tyres slip understeers by K = {UNDERSTEER:g} s²/m²"
    return {"text": text, "holds": abs(_understeer(parameters) - UNDERSTEER) < 0.02 * UNDERSTEER}


def _understeer(parameters: VehicleParameters) -> float:
    """Returns K (s²/m²) of a wide steady turn at the speed of the scenario."""
    plant = plant_of("dynamic", parameters)
    plant.command(parameters.reference_speed, WIDE)
    plant.advance(SETTLED)
    state = plant.state
    rolling = state.v * math.tan(state.delta) / parameters.wheelbase
    return (rolling / plant.yaw_rate - 1.0) / state.v**2
