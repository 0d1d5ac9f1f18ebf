"""What happens when something fails in mid-turn, in virtual time, and what more listeners cost.

- The process that controls the vehicle is cut off: the vehicle stops by its own dead-man rule.
- It is cut off for a while: the drive goes on.
- The controller dies and a new one begins, which knows nothing of the drive before.
- One report of the vehicle goes to more and more listeners.
"""

from __future__ import annotations

import math
import shutil
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from catvehicle.parameters import VehicleParameters

from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions, Drive
from experiments.right_turn.record import PERIOD, STANDSTILL
from experiments.right_turn.sweep import rounded, store, workspaces

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from experiments.right_turn.data import Plan, Run

SEEDS = 3
AWAY = 1.0
"""Seconds for which the process is cut off, or the controller is dead."""
MID_TURN = -math.pi / 4
"""Yaw (rad) at which something fails."""
LISTENERS = (1, 2, 4, 8)
LISTENING = 4.0
"""Seconds for which packets are counted."""
FIRST_LISTENER = 50
"""Component number of the first JAUS listener."""
SOON = 2.0
"""Seconds after which a vehicle is commanded again at the latest; the operator speaks twice in
one, and control that was lost is asked for each second."""


@dataclass(frozen=True)
class Stop:
    """How a vehicle stopped.

    Attributes:
        speed: Speed at the last command, m/s.
        seconds: From the last command to standstill.
        metres: Way of the rear axle in that time.
    """

    speed: float
    seconds: float
    metres: float


def bound(speed: float, parameters: VehicleParameters) -> tuple[float, float]:
    """Returns the longest time (s) and way (m) to standstill after the last command.

    Until the dead-man time is over the vehicle may speed up as hard as it can. Then it brakes, as
    hard as it can and, below the speed at which its lag asks for less, as the lag lets it.

    Args:
        speed: Speed at the last command, m/s.
        parameters: Those of the vehicle.
    """
    waiting, lag = parameters.deadman_timeout, parameters.speed_lag_down
    hardest = -parameters.acceleration_min
    fastest = speed + parameters.acceleration_max * waiting
    slow = min(hardest * lag, fastest)
    seconds = waiting + (fastest - slow) / hardest + lag * math.log(max(slow / STANDSTILL, 1.0))
    metres = fastest * waiting + (fastest**2 - slow**2) / (2 * hardest) + slow * lag
    return seconds, metres


def run(folder: Path, plan: Plan, tell: Callable[[str], None]) -> list[Run]:
    """Lets things fail and writes `summary.json`.

    Args:
        folder: Folder of the stage.
        plan: How much is driven.
        tell: Told how far it is.

    Returns:
        The runs, which were written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for former in folder.iterdir():
        if former.is_dir():
            shutil.rmtree(former)
    tell("generating both systems")
    systems = {name: Workspace.at(place) for name, place in workspaces(folder).items()}
    seeds = range(1, 2 if plan.quick else SEEDS + 1)
    runs: list[Run] = []
    failures: list[dict[str, Any]] = []
    fan_out: list[dict[str, Any]] = []
    for name, workspace in systems.items():
        for seed in seeds:
            for case in (cut_off, cut_for_a_while, restarted):
                tell(f"{name}, seed {seed}: {case.__name__.replace('_', ' ')}")
                found, row = case(Conditions(system=name, seed=seed), workspace)
                runs.append(found)
                failures.append(row)
        for listeners in LISTENERS:
            tell(f"{name}: {listeners} listeners")
            fan_out.append(listened(Conditions(system=name), workspace, listeners))
    for each in runs:
        each.write(each.place(folder))
    summary = {
        "failures": failures,
        "fan_out": fan_out,
        "worst": worst(failures, fan_out),
        "claims": claims(failures, fan_out),
    }
    store(folder, summary)
    return runs


def to_mid_turn(conditions: Conditions, workspace: Workspace) -> Drive:
    """Returns a drive that is in the middle of its turn."""
    drive = Drive(conditions, workspace)
    drive.start()
    samples = drive.record.samples
    drive.world.run_until(lambda: samples and samples[-1].psi < MID_TURN, limit=30.0)
    return drive


def cut_off(conditions: Conditions, workspace: Workspace) -> tuple[Run, dict[str, Any]]:
    """Cuts off what controls the vehicle; returns the run and how the vehicle stopped."""
    drive = to_mid_turn(conditions, workspace)
    drive.controlling_transport.cut()
    drive.run(15.0)
    found = stop_of(drive)
    seconds, metres = bound(found.speed, VehicleParameters())
    return drive.finish(f"cut-off-{conditions.seed:02}"), {
        "system": conditions.system,
        "case": "cut off",
        "seed": conditions.seed,
        "speed": rounded(found.speed),
        "seconds": rounded(found.seconds),
        "metres": rounded(found.metres),
        "most_seconds": rounded(seconds),
        "most_metres": rounded(metres),
        "holds": found.seconds <= seconds + PERIOD and found.metres <= metres,
    }


def stop_of(drive: Drive) -> Stop:
    """Returns how the vehicle stopped after the last command that it took."""
    record = drive.record
    last = max(event.time for event in record.events if event.kind == "command") - record.begun
    after = [sample for sample in record.samples if sample.t >= last - PERIOD]
    standing = [sample.t for sample in after if sample.v < STANDSTILL]
    way = sum(sample.v for sample in after) * PERIOD
    return Stop(after[0].v, min(standing, default=math.inf) - last, way)


def cut_for_a_while(conditions: Conditions, workspace: Workspace) -> tuple[Run, dict[str, Any]]:
    """Cuts off what controls the vehicle, and lets it come back."""
    drive = to_mid_turn(conditions, workspace)
    drive.controlling_transport.cut()
    drive.world.run_for(AWAY)
    drive.controlling_transport.restore()
    return _came_back(drive, "cut off for a while")


def restarted(conditions: Conditions, workspace: Workspace) -> tuple[Run, dict[str, Any]]:
    """Lets the controller die, and begins a new one, which takes its place for the start."""
    drive = to_mid_turn(conditions, workspace)
    if conditions.system == "J":
        drive.controlling_transport.cut()
        drive.world.run_for(AWAY)
        drive.controlling_transport = drive.world.transport()
        drive.start_controller()
    else:
        for node in drive.nodes:
            node.stop()
        drive.world.run_for(AWAY)
        drive.start_nodes()
    return _came_back(drive, "controller restarted")


def _came_back(drive: Drive, case: str) -> tuple[Run, dict[str, Any]]:
    """Drives on for as long as a whole drive takes, and tells when commands came again."""
    back = drive.world.now()
    asked = drive.record.samples[-1].v_cmd
    drive.run(25.0)
    times = [event.time for event in drive.record.events if event.kind == "command"]
    again = min((time for time in times if time > back), default=math.inf) - back
    conditions = drive.conditions
    found = drive.finish(f"{case.replace(' ', '-')}-{conditions.seed:02}")
    return found, {
        "system": conditions.system,
        "case": case,
        "seed": conditions.seed,
        "asked_while_away": rounded(asked),
        "seconds_to_command": rounded(again),
        "arrived": found.arrived,
        "path_error_max": rounded(found.metrics["path_error_max"]),
        "holds": abs(asked) < STANDSTILL and again < SOON,
    }


def listened(conditions: Conditions, workspace: Workspace, listeners: int) -> dict[str, Any]:
    """Counts the packets of the vehicle while one report goes to so many listeners.

    In R they are ROS nodes behind the bridge, in J JAUS components; the controller is the first.
    """
    drive = Drive(conditions, workspace)
    drive.start()
    heard: list[int] = []
    for number in range(1, listeners):
        if conditions.system == "J":
            _listen_by_jaus(drive, workspace, number, heard)
        else:
            _listen_by_ros(drive, workspace, heard)
    drive.run(6.0)
    heard.clear()
    before = drive.vehicle_transport.sent.total()
    drive.run(LISTENING)
    packets = drive.vehicle_transport.sent.total() - before
    drive.finish("listeners")
    return {
        "system": conditions.system,
        "listeners": listeners,
        "packets_per_second": rounded(packets / LISTENING),
        "heard_per_second": rounded(len(heard) / LISTENING),
    }


def _listen_by_ros(drive: Drive, workspace: Workspace, heard: list[int]) -> None:
    types = workspace.module("bridge.ros_types")
    quality = workspace.module("jausml_runtime").Qos(reliability="best_effort", depth=5)
    drive.world.ros.subscribe(
        "/odometry", types.Odometry, lambda data: heard.append(len(data)), qos=quality
    )


def _listen_by_jaus(drive: Drive, workspace: Workspace, number: int, heard: list[int]) -> None:
    runtime = workspace.module("jausml_runtime")
    base = workspace.module("controller.controller_base")
    messages = workspace.module("vehicle.messages")
    address = runtime.JausAddress(100, 1, FIRST_LISTENER + number)
    listener = runtime.JausComponent(
        drive.world.transport(), address, name=f"listener_{number}", services=base.SERVICES
    )
    listener.subscribe(
        base.ControllerBase.VEHICLE,
        messages.QueryVelocityState(),
        messages.ReportVelocityState,
        lambda report, _provider: heard.append(report.CODE),
        rate=VehicleParameters().report_rate,
    )
    listener.start()


def worst(
    failures: Sequence[dict[str, Any]], fan_out: Sequence[dict[str, Any]]
) -> dict[str, dict[str, float]]:
    """Returns the largest of each number of each case, and the packets of the vehicle."""
    found: dict[str, dict[str, float]] = {}
    for row in failures:
        numbers = found.setdefault(f"{row['system']}, {row['case']}", {})
        for name, value in row.items():
            if isinstance(value, float):
                numbers[name] = max(value, numbers.get(name, value))
    for row in fan_out:
        packets = found.setdefault(f"{row['system']}, packets of the vehicle per second", {})
        packets[f"{row['listeners']} listening"] = row["packets_per_second"]
    return found


def claims(
    failures: Sequence[dict[str, Any]], fan_out: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Returns what must hold when something fails, and of listeners behind the bridge."""
    cuts = [row["holds"] for row in failures if row["case"] == "cut off"]
    others = [row["holds"] for row in failures if row["case"] != "cut off"]
    while_away = [row["arrived"] for row in failures if row["case"] == "cut off for a while"]
    rates = {(row["system"], row["listeners"]): row["packets_per_second"] for row in fan_out}
    few, many = min(LISTENERS), max(LISTENERS)
    return [
        {"text": text, "holds": bool(holds)}
        for text, holds in (
            ("cut off in mid-turn, the vehicle stops within its bound", all(cuts)),
            (
                f"after {AWAY:g} s without commands, the vehicle is soon commanded again",
                all(others),
            ),
            (f"cut off for {AWAY:g} s, each drive arrives", all(while_away)),
            (
                "packets of the vehicle do not grow with the nodes",
                rates["R", many] == rates["R", few],
            ),
            ("packets of the vehicle grow with JAUS listeners", rates["J", many] > rates["J", few]),
        )
    ]
