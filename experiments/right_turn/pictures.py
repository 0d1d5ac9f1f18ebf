"""Draws the figures of a run of the experiment from what its stages left."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from catvehicle.evaluation import MOVING
from catvehicle.metrics import Sample
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from matplotlib.figure import Figure

from experiments.right_turn import comparisons, style, turns
from experiments.right_turn.data import HOPS, Run
from experiments.right_turn.results import by_system, runs_of
from experiments.simulator import figure as simulator

_ROWS = {"J": "J, JAUS alone", "R": "R, ROS through the bridge"}


def draw(folder: Path, data: dict[str, Any], target: Path) -> None:
    """Draws what can be drawn, and notes the names of the figures in the data.

    Args:
        folder: Folder of the stages.
        data: What was gathered.
        target: Folder of the figures.

    Raises:
        OSError: A figure cannot be written.
    """
    data["figures"] = []
    for name, figure in _figures(folder):
        style.store(figure, target, name)
        data["figures"].append(name)


def _figures(folder: Path) -> Iterator[tuple[str, Figure]]:
    parameters = VehicleParameters()
    path = StraightArcStraight.right_turn(parameters)
    wall = {
        system: runs
        for system, runs in by_system(runs_of(folder, "wall")).items()
        if system in _ROWS
    }
    drives = {system: moved(runs) for system, runs in wall.items()}
    drives = {system: system_drives for system, system_drives in drives.items() if system_drives}
    if drives:
        rows = [
            turns.Turns(_ROWS[system], system_drives) for system, system_drives in drives.items()
        ]
        yield "turn", turns.draw(rows, path, parameters)
        yield "steering", comparisons.steering(drives)
    if len(drives) == len(_ROWS) and len(drives["J"]) > 1:
        yield "gaps", comparisons.gaps(drives["J"], drives["R"])
    hops = {
        hop: {
            system: [duration for run in runs for duration in run.latencies.get(hop, ())]
            for system, runs in wall.items()
        }
        for hop in HOPS
    }
    if any(any(systems.values()) for systems in hops.values()):
        yield "latency", comparisons.latencies(hops)
    if (folder / "simulator" / "summary.json").exists():
        yield "simulator", simulator.draw(folder / "simulator")


def moved(runs: Sequence[Run]) -> list[Sequence[Sample]]:
    """Returns the drives of runs, from first to last motion, without those that never moved.

    Times count from the first motion, as in the runs.
    """
    drives = []
    for run in runs:
        moving = [index for index, sample in enumerate(run.samples) if sample.v > MOVING]
        if moving:
            drives.append(run.samples[: moving[-1] + 1])
    return drives
