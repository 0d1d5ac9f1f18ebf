"""The stage of faults in real time: what is killed in mid-turn, and what many subscribers cost.

`summary.json` holds the numbers and the claims that they carry:

- the bridge is killed without a warning: the vehicle stops by its own dead-man rule;
- the JAUS controller of the other system is killed: it stops just so;
- the speed controller behind the bridge is killed and started again: the vehicle drives on;
- one JAUS stream goes to more and more ROS nodes: the vehicle sends no more for that.
"""

from __future__ import annotations

import itertools
import json
import time
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from catvehicle.events import read_events
from catvehicle.metrics import Sample, read_log
from catvehicle.parameters import VehicleParameters

from experiments.right_turn.drives import (
    DRIVE_LIMIT,
    STANDSTILL,
    START_LIMIT,
    Drive,
    collect,
    is_at_end,
)
from experiments.right_turn.systems import (
    BRIDGED,
    JAUS_ALONE,
    OPERATOR,
    Running,
    Setting,
    Workspace,
    generate,
    wait_for,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from experiments.right_turn.data import Plan, Run

IN_TURN = -0.6
"""Yaw in rad, a third of the turn, at which something is killed."""

LISTENERS = (1, 4)
"""ROS nodes that listen to one JAUS stream."""

COUNTED = 4.0
"""Seconds in which messages are counted."""

RECORDED = 0.01
"""Seconds between two samples of the truth."""


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Lets things fail; a quick plan kills the bridge and the JAUS controller only.

    Raises:
        RuntimeError: A system does not run.
    """
    alone = generate(JAUS_ALONE, folder / "ws" / "J")
    bridged = generate(replace(BRIDGED, leaves_out=frozenset()), folder / "ws" / "R")
    tell("killing bridge and controller in mid-turn")
    runs, summary = _killed(alone, bridged, folder / "logs", is_quick=plan.quick)
    if not plan.quick:
        tell("one stream to many nodes")
        summary["listeners"] = _listened(bridged, folder / "logs" / "listeners")
    summary["claims"] = claims(summary)
    for each in runs:
        each.write(each.place(folder))
    (folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    return runs


def claims(summary: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns what must hold, and whether it does."""
    told = []
    for name, words in (("bridge", "the bridge"), ("controller", "the JAUS controller")):
        if name in summary["killed"]:
            found = summary["killed"][name]
            told.append(
                {
                    "text": f"{words} killed in mid-turn: the dead-man rule stops the vehicle "
                    "in time",
                    "holds": found["silence"] <= found["silence_bound"]
                    and found["distance"] <= found["distance_bound"],
                }
            )
    if "restarted" in summary:
        text = "the speed controller killed and started again: the vehicle drives on and arrives"
        told.append({"text": text, "holds": summary["restarted"]["arrived"]})
    if "listeners" in summary:
        counts = summary["listeners"]
        rates = [each["reports_per_second"] for each in counts]
        heard = all(each["heard_least"] > 0 for each in counts)
        # A tenth: a report more or less at either end of the time in which they are counted.
        told.append(
            {
                "text": "one JAUS stream to several ROS nodes: JAUS reports do not grow with nodes",
                "holds": heard and max(rates) <= 1.1 * min(rates),
            }
        )
    return told


def stopping(
    samples: Sequence[Sample], last_command: float, parameters: VehicleParameters
) -> dict[str, float]:
    """Returns how a vehicle stopped that gets no commands any more, and how it had to.

    Args:
        samples: The truth, until the vehicle stands.
        last_command: Time of the last speed command, s on the clock of the samples.
        parameters: Of the vehicle.

    Returns:
        `silence` (s from the last command to the stop command of the dead-man rule) and `distance`
        (m from the last command to rest), with their bounds; infinite when it did not stop.
    """
    after = [sample for sample in samples if sample.t >= last_command]
    stopped = next((sample.t for sample in after if sample.v_cmd == 0.0), float("inf"))
    rest = next((i for i, sample in enumerate(after) if sample.v < STANDSTILL), None)
    way = after[: rest + 1] if rest is not None else []
    steps = itertools.pairwise(way)
    distance = sum(((b.x - a.x) ** 2 + (b.y - a.y) ** 2) ** 0.5 for a, b in steps)
    speed = after[0].v if after else 0.0
    return {
        "speed": speed,
        "silence": stopped - last_command,
        "silence_bound": parameters.deadman_timeout + 2 * RECORDED,
        "distance": distance if way else float("inf"),
        "distance_bound": braking_distance(speed, parameters),
    }


def braking_distance(speed: float, parameters: VehicleParameters) -> float:
    """Returns the longest way to rest (m) of a vehicle at a speed (m/s) without commands.

    It may speed up for the dead-man time; then braking saturates down to the speed from which on
    the lag of the speed decides, with which it would come to rest within speed times lag.
    """
    silence = parameters.deadman_timeout + 2 * RECORDED
    fastest = speed + parameters.acceleration_max * silence
    lag, hardest = parameters.speed_lag_down, -parameters.acceleration_min
    gentle = min(fastest, hardest * lag)
    return fastest * silence + (fastest**2 - gentle**2) / (2 * hardest) + gentle * lag


def _killed(
    alone: Workspace, bridged: Workspace, logs: Path, *, is_quick: bool
) -> tuple[list[Run], dict[str, Any]]:
    """Kills bridge, JAUS controller and speed controller, each in its own system at once."""
    cases = [("bridge", bridged), ("controller", alone)]
    if not is_quick:
        cases.append(("velocity_controller", bridged))
    summary: dict[str, Any] = {"killed": {}}
    with ExitStack() as stack:
        systems = {
            victim: stack.enter_context(Running(workspace, Setting(place=place), logs / victim))
            for place, (victim, workspace) in enumerate(cases)
        }
        running = list(systems.values())
        for system in running:
            system.start(*(each for each in system.workspace.processes if _is_needed(each)))
        if not wait_for(lambda: all(each.steps for each in running), START_LIMIT, running):
            raise RuntimeError(f"no command in {START_LIMIT:.0f} s; see {logs}")
        for system in running:
            system.start(OPERATOR)
        _kill_in_turn(systems)
        for victim in ("bridge", "controller"):
            system = systems[victim]
            wait_for(lambda system=system: _speed(system) < STANDSTILL, DRIVE_LIMIT, [system])
            summary["killed"][victim] = _stopped(system)
        if "velocity_controller" in systems:
            system = systems["velocity_controller"]
            arrived = wait_for(lambda: _is_at_end(system), DRIVE_LIMIT, [system])
            summary["restarted"] = {"arrived": arrived}
        for system in running:
            system.stop()
        runs = [
            replace(
                collect(Drive(system.workspace, f"{victim}_killed", system.setting), system),
                config={"killed": victim},
            )
            for victim, system in systems.items()
        ]
    return runs, summary


def _is_needed(process: str) -> bool:
    return process not in {OPERATOR, "logger"}


def _kill_in_turn(systems: dict[str, Running]) -> None:
    """Kills each victim as its vehicle is in the turn; starts the speed controller again."""
    left = dict(systems)

    def kill_those_in_turn() -> bool:
        for victim, system in list(left.items()):
            sample = _truth(system)
            if sample is not None and sample.psi < IN_TURN:
                system.kill(victim)
                del left[victim]
                if victim == "velocity_controller":
                    system.start(victim)
        return not left

    if not wait_for(kill_those_in_turn, DRIVE_LIMIT, list(systems.values())):
        raise RuntimeError(f"no turn in {DRIVE_LIMIT:.0f} s: {', '.join(left)}")


def _truth(system: Running) -> Sample | None:
    """Returns the last whole sample that a vehicle has written."""
    with (system.logs / "vehicle.csv").open("rb") as file:
        size = file.seek(0, 2)
        file.seek(max(0, size - 1000))
        lines = file.read().decode().split("\n")[1:-1]
    return Sample(*map(float, lines[-1].split(","))) if len(lines) > 1 else None


def _speed(system: Running) -> float:
    sample = _truth(system)
    return float("inf") if sample is None else sample.v


def _is_at_end(system: Running) -> bool:
    sample = _truth(system)
    return sample is not None and is_at_end(sample)


def _stopped(system: Running) -> dict[str, float]:
    events = read_events(system.logs / "vehicle_events.csv")
    start = next(float(row[1]) for row in events if row[0] == "start")
    last = max(float(row[1]) for row in events if row[0] == "speed") - start
    return stopping(read_log(system.logs / "vehicle.csv"), last, VehicleParameters())


def _listened(bridged: Workspace, logs: Path) -> list[dict[str, Any]]:
    """Counts the reports of a standing vehicle while more and more nodes listen to them."""
    found = []
    with Running(bridged, Setting(), logs) as system:
        system.start("vehicle", "bridge")
        folders: list[Path] = []
        for count in LISTENERS:
            while len(folders) < count:
                folders.append(system.start_another("logger", len(folders)))
            if not wait_for(lambda: all(map(_heard, folders)), START_LIMIT, [system]):
                raise RuntimeError(f"a listener hears nothing; see {logs}")
            found.append(_counted(system, folders))
    return found


def _counted(system: Running, folders: Sequence[Path]) -> dict[str, Any]:
    heard_before = [_heard(folder) for folder in folders]
    begin, sent_before = time.monotonic(), _sent(system)
    wait_for(lambda: False, COUNTED, [system])
    passed = time.monotonic() - begin
    sent = _sent(system) - sent_before
    heard = [_heard(each) - before for each, before in zip(folders, heard_before, strict=True)]
    return {
        "nodes": len(folders),
        "reports_per_second": sent / passed,
        "heard_least": min(heard) / passed,
    }


def _sent(system: Running) -> int:
    return sum(row[0] == "report" for row in read_events(system.logs / "vehicle_events.csv"))


def _heard(folder: Path) -> int:
    return sum(row[0] == "odometry" for row in read_events(folder / "logger.csv"))
