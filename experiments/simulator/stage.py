"""Runs the simulated car at several paces, and writes what was measured."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

from experiments.processes import (
    ExperimentError,
    Process,
    Processes,
    free_port,
    generate,
    wait_until,
)
from experiments.right_turn.data import Plan

from . import CATVEHICLE, MODELS
from .results import PATH_TOLERANCE, RATE, TOLERANCE, Result, arrivals, judge, spread

EXAMPLE = MODELS / "examples" / "simulator"
PATIENCE = 40.0
"""Seconds until the first event must have come."""
DRIVE_LIMIT = 70.0
"""Seconds in which a car must have arrived."""
FIRST_DOMAIN = 71
"""ROS domain of the first run; each has one of its own."""
CHANGING = Path(__file__).with_name("change_factor.py")
FIRST_FACTOR = 4.0
"""Seconds with the first factor of a run in which it changes."""
SCHEDULE = ("0.5:4", "2:4", "0:2", "1:4")
"""Factors of the run in which they change, each with its seconds; it begins with 1."""


@dataclass(frozen=True)
class Condition:
    """How a run is made.

    Attributes:
        name: Its name.
        factor: The real-time factor at its begin.
        follows_clock: Whether the bridge is started with use_sim_time.
        schedule: Factors that are set one after the other, each with its seconds.
        seconds: Seconds of real time after the first event; None runs to the end of the schedule,
            or until the car has arrived.
    """

    name: str
    factor: float
    follows_clock: bool = True
    schedule: tuple[str, ...] = ()
    seconds: float | None = None


CONDITIONS = (
    Condition("half", 0.5),
    Condition("real", 1.0),
    Condition("double", 2.0),
    Condition("changing", 1.0, schedule=SCHEDULE),
    # What must fail: a bridge in real time beside a slow simulation.
    Condition("wall_clock", 0.5, follows_clock=False, seconds=15.0),
)
QUICK = (Condition("real", 1.0, seconds=2.5),)


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Result]:
    """Makes all runs, side by side, and judges them.

    Args:
        folder: Where each run gets a folder, beside `summary.json`.
        plan: `quick` makes one short run.
        tell: Is told how it goes.

    Raises:
        ExperimentError: A run could not be made.
    """
    for condition in CONDITIONS:  # what a longer run has left would be drawn beside this one
        shutil.rmtree(folder / condition.name, ignore_errors=True)
    return run_conditions(folder, QUICK if plan.quick else CONDITIONS, tell)


def run_conditions(
    folder: Path, conditions: Sequence[Condition], tell: Callable[[str], None]
) -> list[Result]:
    """Makes runs of these conditions, as `run` does."""
    folder.mkdir(parents=True, exist_ok=True)
    workspace = folder / "ws"
    tell("generating the simulated car")
    generate(EXAMPLE / "simulator.ros2jaus", workspace, EXAMPLE / "src" / "driver", CATVEHICLE)
    tell(f"driving beside the simulator, {len(conditions)} runs at once")
    with ThreadPoolExecutor(len(conditions)) as pool:
        running = [
            pool.submit(_drive, folder / condition.name, workspace, condition, FIRST_DOMAIN + at)
            for at, condition in enumerate(conditions)
        ]
        results = []
        for future in running:
            results.append(future.result())
            tell(_described(results[-1]))
    _summarize(folder, results)
    return results


def _drive(folder: Path, workspace: Path, condition: Condition, domain: int) -> Result:
    """Makes one run in its folder, and judges it."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    environment = {"SIMULATOR_LOG": str(folder), "ROS_DOMAIN_ID": str(domain)}
    with Processes(folder, environment) as processes:
        system = _start(processes, folder, workspace, condition)
        events = folder / "driver.csv"
        if not wait_until(lambda: events.exists() and len(arrivals(folder)) > 1, PATIENCE):
            raise ExperimentError(f"no event came within {PATIENCE:g} s; see {folder}")
        if condition.schedule:
            time.sleep(FIRST_FACTOR)
            processes.start(
                "factors", CHANGING, folder / "factors.csv", *condition.schedule
            ).wait_for("all factors were set", PATIENCE)
        elif condition.seconds is not None:
            time.sleep(condition.seconds)
        else:
            system.wait_for("arrived at", DRIVE_LIMIT)
    result = judge(
        folder,
        condition.name,
        follows_clock=condition.follows_clock,
        arrived=system.said("arrived at"),
    )
    result.write(folder)
    return result


def _start(processes: Processes, folder: Path, workspace: Path, condition: Condition) -> Process:
    """Starts simulator, bridge and driver; returns the last two, which are one command."""
    simulator = ("-p", f"real_time_factor:={condition.factor}", "-p")
    log = f"log:={folder / 'simulator.csv'}"
    processes.start("simulator", EXAMPLE / "stand_in.py", "--ros-args", *simulator, log)
    clock = ("-p", f"use_sim_time:={str(condition.follows_clock).lower()}")
    command = ("-m", "jausml", "run", workspace, "--jaus-port", str(free_port()))
    return processes.start("system", *command, "--ros-args", *clock)


def _described(result: Result) -> str:
    """Returns a line on a run."""
    rates = ", ".join(
        f"{segment.real_rate:.2f}/s at {segment.pace:.2f}x" for segment in result.segments
    )
    return f"{result.name}: {rates}"


def _summarize(folder: Path, results: list[Result]) -> None:
    summary = {
        "rate": RATE,
        "rate_tolerance": TOLERANCE,
        "path_tolerance_m": PATH_TOLERANCE,
        "path_difference_m": spread(results),
        "claims": [{"text": text, "holds": holds} for text, holds in _claims(results)],
        "runs": {result.name: asdict(result) for result in results},
    }
    text = json.dumps(summary, indent=2, sort_keys=True, allow_nan=False)
    (folder / "summary.json").write_text(text + "\n", encoding="utf-8")


def _claims(results: list[Result]) -> Iterator[tuple[str, bool | None]]:
    """Yields what must hold, and whether it does; None where the machine was too slow to tell."""
    for result in results:
        if result.follows_clock:
            yield (
                f"simulator, {result.name}: events keep the pace of the simulation",
                result.follows,
            )
        else:
            text = f"simulator, {result.name}: a bridge in real time does not keep the pace"
            yield text, not result.follows
    difference = spread(results)
    if difference is not None:
        text = f"the path is the same at each pace, within {PATH_TOLERANCE:g} m"
        was_held = all(result.held_pace for result in results if result.path_error is not None)
        yield text, difference <= PATH_TOLERANCE if was_held else None
