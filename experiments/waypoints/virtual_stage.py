"""The part of the stage in virtual time: J and R, their paths, and what must be refused."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from experiments.right_turn.generated import Workspace

from . import drives
from .controls import CONTROLS, LATE
from .equivalence import bound, path_gap, path_of
from .systems import SYSTEMS
from .virtual import Conditions, VirtualDrive

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from .drives import Point
    from .results import Result

SEEDS = 5
"""Pairs of drives of J and R along the whole list."""
KINDS = (drives.WHOLE, drives.EMERGENCY, drives.LOST)


def driven(workspaces: Path, tell: Callable[[str], None], *, quick: bool = False) -> dict[str, Any]:
    """Drives in virtual time, and returns what came of it, with its claims.

    Args:
        workspaces: Folder of the generated systems.
        quick: Whether one pair is enough.
    """
    places = {name: Workspace.at(workspaces / name) for name in SYSTEMS}

    def drive(
        conditions: Conditions, kind: drives.Drive = drives.WHOLE
    ) -> tuple[Result, list[Point]]:
        made = VirtualDrive(kind, conditions, places[conditions.system])
        return made.run(), path_of(made.record.truth)

    tell("driving in virtual time")
    runs = {
        f"{name}, {kind.name}": drive(Conditions(name), kind) for name in places for kind in KINDS
    }
    paths = {name: [runs[f"{name}, whole"][1]] for name in places}
    for seed in range(2, 1 + (1 if quick else SEEDS)):
        for name in places:
            paths[name].append(drive(Conditions(name, seed))[1])
    tell("driving what must be refused")
    refused = {name: drive(each.conditions, each.drive)[0] for name, each in CONTROLS.items()}
    late, path = drive(LATE)
    gaps = {
        "R from J": max(map(path_gap, paths["J"], paths["R"])),
        "J from J": max((path_gap(paths["J"][0], each) for each in paths["J"][1:]), default=0.0),
        "R, 100 ms late": path_gap(paths["J"][0], path),
    }
    return {
        "runs": {name: asdict(result) for name, (result, _) in runs.items()},
        "controls": {name: _control(name, result) for name, result in refused.items()},
        "gaps": gaps,
        "bound": bound(),
        "claims": [
            *_claims({name: result for name, (result, _) in runs.items()}),
            *(
                {"text": f"waypoints: {CONTROLS[name].about}: refused", "holds": not _is_good(each)}
                for name, each in refused.items()
            ),
            *_claims_of_paths(gaps, late),
        ],
    }


def _claims(runs: Mapping[str, Result]) -> list[dict[str, Any]]:
    return [
        {"text": f"waypoints, virtual time, {name}: as required", "holds": _is_good(result)}
        for name, result in runs.items()
    ]


def _claims_of_paths(gaps: Mapping[str, float], late: Result) -> list[dict[str, Any]]:
    most = bound()
    within = f"within {most:.3f} m of those of J"
    return [
        {
            "text": f"waypoints, virtual time: the paths of R lie {within}",
            "holds": gaps["R from J"] <= most,
        },
        {
            "text": "waypoints, virtual time: so do those of J with other seeds",
            "holds": gaps["J from J"] <= most,
        },
        {
            "text": "waypoints, virtual time: odometry that is 100 ms late is told by its path",
            "holds": _is_good(late) and gaps["R, 100 ms late"] > most,
        },
    ]


def _is_good(result: Result) -> bool:
    return all(result.claims.values())


def _control(name: str, result: Result) -> dict[str, Any]:
    broken = [text for text, holds in result.claims.items() if not holds]
    return {"about": CONTROLS[name].about, "drive": result.name, "by": broken}
