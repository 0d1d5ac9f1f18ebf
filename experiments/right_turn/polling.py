"""The paper's own bridge, as far as it can be told: one that polls, beside the generated one.

The same models, nodes and vehicle; the bridge looks at what arrived on either side at the
frequency that it was given, as the paper says of its own, and carries the newest
(`polling_ros.py`). A vehicle that stops when it hears nothing for 0.2 s would hardly move below
5 Hz, so there it is driven twice: as it is, and with a vehicle and a bridge that wait for two
periods and a half, so that the delay can be seen alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from catvehicle.parameters import VehicleParameters

from experiments.right_turn.cells import Cell
from experiments.right_turn.loops import Conditions
from experiments.right_turn.pool import Pool
from experiments.right_turn.sweep import Sweep, store

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from experiments.right_turn.data import Plan, Run

FREQUENCIES = (1, 5, 10, 20, 50)
"""Looks each second."""

SEEDS = 3

PATIENCE = 2.5
"""Periods that a patient vehicle waits for a command."""


def cells(plan: Plan) -> list[Cell]:
    """Returns the generated bridge, and one that polls at each frequency."""
    seeds = 1 if plan.quick else min(SEEDS, plan.runs)
    deadman = VehicleParameters().deadman_timeout
    found = [Cell("events", Conditions(), {"group": "events"}, seeds, is_kept=True)]
    for frequency in (5, 20) if plan.quick else FREQUENCIES:
        patience = PATIENCE / frequency if PATIENCE / frequency > deadman else 0.0
        about = {"group": "polling", "frequency": frequency}
        conditions = Conditions(polling=float(frequency), patience=patience)
        patient = about | {"patience": patience or deadman}
        found.append(Cell(f"poll-{frequency}", conditions, patient, seeds, is_kept=True))
        if patience:
            conditions = Conditions(polling=float(frequency))
            strict = about | {"group": "impatient", "patience": deadman}
            found.append(Cell(f"poll-{frequency}-impatient", conditions, strict, seeds))
    return found


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Drives with each bridge and writes `summary.json`.

    Args:
        folder: Folder of the stage.
        plan: How much is driven.
        tell: Told how far it is.

    Returns:
        The runs that were written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with Pool() as pool:
        sweep = Sweep(folder, pool, tell)
        rows = sweep.drive(cells(plan))
    store(folder, {"cells": rows, "claims": claims(rows)})
    return sweep.kept


def claims(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Returns what must hold: polls delay, and events do not."""
    (events,) = (row["most"] for row in rows if row["group"] == "events")
    polls = [row["most"].get("sense_act_p50", 0.0) for row in rows if row["group"] == "polling"]
    text = "virtual time: each bridge that polls takes longer than the one that waits for events"
    return [{"text": text, "holds": all(events["sense_act_p99"] < each for each in polls)}]
