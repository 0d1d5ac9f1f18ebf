"""Has a robot driven along lists, and writes what was measured."""

from __future__ import annotations

import json
import os
import shutil
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from type_support import CannotBuildError, built

from experiments.processes import ExperimentError, Processes, free_port

from . import EXAMPLE
from .drives import EMERGENCY, LIMIT, SHORT, WATCHED, WHOLE
from .equivalence import IN_REAL_TIME, bound, path_gap, path_of
from .results import TOLERANCE, Result, events, judge, states
from .systems import SYSTEMS, generated
from .virtual_stage import driven

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from experiments.right_turn.data import Plan

    from .drives import Drive

ACTION = ("msg/MissedWaypoint.msg", "action/FollowWaypoints.action")
"""What is made of nav2_msgs."""
FIRST_DOMAIN = 81
"""ROS domain of the first drive; each has one of its own."""


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Result]:
    """Has the lists driven, side by side, and judges the drives.

    Args:
        folder: Where each drive gets a folder, beside `summary.json`.
        plan: `quick` drives two waypoints.
        tell: Is told how it goes.

    Raises:
        ExperimentError: A drive could not be made, e.g. since there is no compiler for nav2_msgs,
            of which there is no wheel.
    """
    results = run_drives(folder, (SHORT,) if plan.quick else (WHOLE, EMERGENCY), tell)
    virtual = driven(folder / "ws", tell, quick=plan.quick)
    _summarize(folder, results, virtual)
    return list(results.values())


def run_drives(
    folder: Path, drives: Sequence[Drive], tell: Callable[[str], None]
) -> dict[str, Result]:
    """Has these lists driven by both systems in real time; returns results by system and list."""
    folder.mkdir(parents=True, exist_ok=True)
    tell("making nav2_msgs, twenty seconds at the first time")
    try:
        action = built("nav2_msgs", ACTION)
    except CannotBuildError as error:
        raise ExperimentError(str(error)) from None
    tell("generating both systems")
    path = os.pathsep.join(filter(None, [str(action), os.environ.get("PYTHONPATH")]))
    wanted = []
    for system in SYSTEMS:
        shutil.rmtree(folder / system, ignore_errors=True)  # what a longer run has left, too
        workspace = generated(system, folder / "ws" / system)
        wanted += [(system, each, workspace) for each in drives]
    tell(f"driving {len(wanted)} lists")
    with ThreadPoolExecutor(len(wanted)) as pool:
        running = {
            f"{system}, {each.name}": pool.submit(
                _drive,
                folder / system / each.name,
                system,
                each,
                workspace,
                FIRST_DOMAIN + at,
                path,
            )
            for at, (system, each, workspace) in enumerate(wanted)
        }
        results = {}
        for name, each in running.items():
            results[name] = each.result()
            tell(f"{name}: {_told(results[name])}")
    return results


def _drive(
    folder: Path, system: str, drive: Drive, workspace: Path, domain: int, path: str
) -> Result:
    """Has one list driven in its folder, and judges it."""
    folder.mkdir(parents=True)
    (folder / "plan.json").write_text(json.dumps(drive.plan) + "\n", encoding="utf-8")
    environment = {
        "WAYPOINT_LOG": str(folder),
        "ROS_DOMAIN_ID": str(domain),
        "PYTHONPATH": path,
    }
    with Processes(folder, environment) as processes:
        if system == "R":
            log = f"log:={folder / 'wheels.csv'}"
            processes.start("wheels", EXAMPLE / "wheels.py", "--ros-args", "-p", log)
            processes.start("follower", EXAMPLE / "follower.py")
        command = ("-m", "jausml", "run", workspace, "--jaus-port", str(free_port()))
        running = processes.start("system", *command)
        running.wait_for("the list ended", LIMIT)
        if drive.emergency_at is not None:
            time.sleep(WATCHED)
    result = judge(drive, states(folder), events(folder))
    result.write(folder)
    return result


def _told(result: Result) -> str:
    """Returns a line on a drive."""
    passed = [each for each in result.passages if each.nearest is not None]
    held = sum(result.claims.values())
    line = f"{len(passed)} of {len(result.waypoints)} waypoints were active"
    return f"{line}, {held} of {len(result.claims)} claims hold"


def _summarize(folder: Path, results: Mapping[str, Result], virtual: Mapping[str, Any]) -> None:
    paths = [path_of(states(folder / system / WHOLE.name)) for system in SYSTEMS]
    gap = path_gap(*paths)
    most = bound(tuple(results[f"R, {WHOLE.name}"].waypoints), IN_REAL_TIME)
    apart = f"waypoints, real time: the path of R lies within {most:.3f} m of that of J"
    summary = {
        "tolerance_m": TOLERANCE,
        "claims": [
            {"text": f"waypoints, {name}: {text}", "holds": holds}
            for name, each in results.items()
            for text, holds in each.claims.items()
        ]
        + [{"text": apart, "holds": gap <= most}, *virtual["claims"]],
        "runs": {name: asdict(each) for name, each in results.items()},
        "gap": gap,
        "bound": most,
        "virtual": {name: each for name, each in virtual.items() if name != "claims"},
    }
    text = json.dumps(summary, indent=2, sort_keys=True, allow_nan=False)
    (folder / "summary.json").write_text(text + "\n", encoding="utf-8")
