"""Tells whether generated packages still do what the experiments require.

Usage: python -m experiments.verdict right_turn|waypoints [FOLDER]

The folder holds the packages of R, without code of users; by default it is that which the variable
JAUSML_WORKSPACE names, as `jausml mutate --run` says it. They drive in virtual time, with the code
of the examples. What is required is an oracle of its own: it says where a vehicle must come, and
knows nothing of the model. The exit status is 1, and the last line says why, when it is not met.
"""

from __future__ import annotations

import logging
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.right_turn import loops
from experiments.right_turn.generated import Workspace
from experiments.right_turn.stress_virtual import restarted
from experiments.right_turn.systems import BRIDGED
from experiments.waypoints.systems import SYSTEMS
from experiments.waypoints.virtual import Conditions, VirtualDrive
from experiments.waypoints.virtual_stage import KINDS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from experiments.right_turn.systems import System

PATH_ERROR = 0.29
"""Metres from the path of the right turn at most: what J drives, and what judging allows R."""


def right_turn(folder: Path, place: Path) -> Iterator[str]:
    """Yields what is wrong with the right turn, and with its stop when the ROS nodes die."""
    workspace = _with_code(BRIDGED, folder, place)
    run = loops.drive(loops.Conditions(), workspace, "verdict")
    if not run.arrived:
        yield "the vehicle does not arrive"
        return
    if run.metrics["violation_fraction"] > 0:
        yield "the vehicle leaves the safe region"
    if run.metrics["path_error_max"] > PATH_ERROR:
        yield f"the vehicle is {run.metrics['path_error_max']:.2f} m from its path"
    _, row = restarted(loops.Conditions(), workspace)
    if not row["holds"]:
        yield "the vehicle is not stopped while its controllers are away, or not driven on after"


def waypoints(folder: Path, place: Path) -> Iterator[str]:
    """Yields what is wrong with drives along a list, with an emergency and without an operator."""
    workspace = _with_code(SYSTEMS["R"], folder, place)
    for kind in KINDS:
        result = VirtualDrive(kind, Conditions(), workspace).run()
        yield from (
            f"{kind.name}: not so: {text}" for text, holds in result.claims.items() if not holds
        )


VERDICTS: Mapping[str, Callable[[Path, Path], Iterator[str]]] = {
    "right_turn": right_turn,
    "waypoints": waypoints,
}


def _with_code(system: System, folder: Path, place: Path) -> Workspace:
    """Returns a copy of a workspace, with the code of users in the place of skeletons."""
    for each in folder.iterdir():
        if each.name == "jausml_runtime":
            (place / each.name).symlink_to(each.resolve())
        elif each.is_dir():
            shutil.copytree(each, place / each.name)
    for source in system.sources:
        shutil.copytree(source, place / source.name, dirs_exist_ok=True)
    return Workspace.at(place)


def main(arguments: list[str]) -> int:
    """Says what is wrong, if anything is; returns the exit status."""
    name, *given = arguments
    folder = Path(given[0] if given else os.environ["JAUSML_WORKSPACE"])
    with tempfile.TemporaryDirectory(prefix="jausml_verdict_") as place:
        try:
            problem = next(VERDICTS[name](folder, Path(place)), "")
        except Exception as error:  # of broken code, whatever it may be
            problem = f"{type(error).__name__}: {error}"
    if problem:
        sys.stdout.write(f"{problem}\n")
    return 1 if problem else 0


if __name__ == "__main__":
    logging.disable()
    sys.exit(main(sys.argv[1:]))
