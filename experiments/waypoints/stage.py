"""Has a robot driven along lists, and writes what was measured."""

from __future__ import annotations

import json
import os
import shutil
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from type_support import CannotBuildError, built

from experiments.processes import ExperimentError, Processes, free_port, generate

from . import EXAMPLE
from .results import TOLERANCE, Point, Result, events, judge, states

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from experiments.right_turn.data import Plan

ACTION = ("msg/MissedWaypoint.msg", "action/FollowWaypoints.action")
"""What is made of nav2_msgs."""
FIRST_DOMAIN = 81
"""ROS domain of the first drive; each has one of its own."""
LIMIT = 60.0
"""Seconds in which a list must have ended."""
WATCHED = 2.0
"""Seconds in which the robot is watched after an emergency."""


@dataclass(frozen=True)
class Drive:
    """A list, and what happens on the way.

    Attributes:
        name: Its name.
        waypoints: Where they are, m, in ROS axes: x forward, y left of the start.
        emergency_at: Element on the way to which there is an emergency; None for none.
    """

    name: str
    waypoints: tuple[Point, ...]
    emergency_at: int | None = None


LIST: tuple[Point, ...] = (
    (2.0, 0.0),
    (4.0, 1.5),
    (6.0, 0.0),
    (6.0, -2.5),
    (4.0, -3.5),
    (2.0, -2.0),
    (0.0, -2.0),
    (0.0, 0.0),
)
DRIVES = (Drive("whole", LIST), Drive("emergency", LIST, emergency_at=3))
QUICK = (Drive("whole", ((1.0, 0.0), (1.8, -0.8))),)


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
    for each in DRIVES:  # what a longer run has left would be drawn beside this one
        shutil.rmtree(folder / each.name, ignore_errors=True)
    return run_drives(folder, QUICK if plan.quick else DRIVES, tell)


def run_drives(folder: Path, drives: Sequence[Drive], tell: Callable[[str], None]) -> list[Result]:
    """Has these lists driven, as `run` does."""
    folder.mkdir(parents=True, exist_ok=True)
    tell("making nav2_msgs, twenty seconds at the first time")
    try:
        action = built("nav2_msgs", ACTION)
    except CannotBuildError as error:
        raise ExperimentError(str(error)) from None
    tell("generating the robot's bridge and the operator")
    workspace = folder / "ws"
    generate(EXAMPLE / "waypoint_list.ros2jaus", workspace, EXAMPLE / "src" / "operator_unit")
    tell(f"driving {len(drives)} lists")
    path = os.pathsep.join(filter(None, [str(action), os.environ.get("PYTHONPATH")]))
    with ThreadPoolExecutor(len(drives)) as pool:
        running = [
            pool.submit(_drive, folder / each.name, workspace, each, FIRST_DOMAIN + at, path)
            for at, each in enumerate(drives)
        ]
        results = []
        for each in running:
            results.append(each.result())
            tell(_told(results[-1]))
    _summarize(folder, results)
    return results


def _drive(folder: Path, workspace: Path, drive: Drive, domain: int, path: str) -> Result:
    """Has one list driven in its folder, and judges it."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    # JAUS has y to the right.
    plan = {
        "waypoints": [[x, -y] for x, y in drive.waypoints],
        "emergency_at": drive.emergency_at,
    }
    (folder / "plan.json").write_text(json.dumps(plan) + "\n", encoding="utf-8")
    environment = {
        "WAYPOINT_LOG": str(folder),
        "ROS_DOMAIN_ID": str(domain),
        "PYTHONPATH": path,
    }
    with Processes(folder, environment) as processes:
        log = f"log:={folder / 'wheels.csv'}"
        processes.start("wheels", EXAMPLE / "wheels.py", "--ros-args", "-p", log)
        processes.start("follower", EXAMPLE / "follower.py")
        command = ("-m", "jausml", "run", workspace, "--jaus-port", str(free_port()))
        system = processes.start("system", *command)
        system.wait_for("the list ended", LIMIT)
        if drive.emergency_at is not None:
            time.sleep(WATCHED)
    result = judge(drive.name, drive.waypoints, states(folder), events(folder))
    result.write(folder)
    return result


def _told(result: Result) -> str:
    """Returns a line on a drive."""
    passed = [each for each in result.passages if each.nearest is not None]
    held = sum(result.claims.values())
    line = f"{result.name}: {len(passed)} of {len(result.waypoints)} waypoints were active"
    return f"{line}, {held} of {len(result.claims)} claims hold"


def _summarize(folder: Path, results: list[Result]) -> None:
    summary = {
        "tolerance_m": TOLERANCE,
        "claims": [
            {"text": f"waypoints, {each.name}: {text}", "holds": holds}
            for each in results
            for text, holds in each.claims.items()
        ],
        "runs": {each.name: asdict(each) for each in results},
    }
    text = json.dumps(summary, indent=2, sort_keys=True, allow_nan=False)
    (folder / "summary.json").write_text(text + "\n", encoding="utf-8")
