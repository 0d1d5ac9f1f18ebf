"""Judges a run of the whole system by the logs that its processes left."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .events import read_events
from .figure import draw_run
from .metrics import (
    LatencySummary,
    Sample,
    Table,
    comfort,
    latency_summary,
    path_error,
    read_log,
    total_variation,
)
from .path import StraightArcStraight

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from .parameters import VehicleParameters

MOVING = 0.02
"""Speed in m/s from which on the vehicle is taken to move."""

QUANTUM = 2e-5
"""Tolerance in rad when commands before and after the bridge are matched; one step of the effort
field is 1.6e-5 rad."""


@dataclass(frozen=True)
class Latencies:
    """Seconds that messages took on their ways.

    Attributes:
        to_ros: From the vehicle's report to the ROS callback, through the bridge.
        to_jaus: From the publication of a command to the vehicle's handler, through the bridge.
        loop: From the vehicle's report to the command that answers it, controller included.
    """

    to_ros: LatencySummary
    to_jaus: LatencySummary
    loop: LatencySummary


def driven(samples: Sequence[Sample]) -> list[Sample]:
    """Returns the part of a run from the first to the last motion.

    Raises:
        ValueError: The vehicle never moved.
    """
    moving = [index for index, sample in enumerate(samples) if sample.v > MOVING]
    if not moving:
        raise ValueError("the vehicle never moved")
    return list(samples[moving[0] : moving[-1] + 1])


def latencies(logs: Path) -> Latencies:
    """Matches the events of the vehicle and the steering controller on the machine's clock.

    Reports are matched by their time stamp (ms), commands by their order and value.
    """
    vehicle = read_events(logs / "vehicle_events.csv")
    sent = {int(row[2]): float(row[1]) for row in vehicle if row[0] == "report"}
    arrived = [(float(row[1]), float(row[2])) for row in vehicle if row[0] == "command"]
    times = [time for time, _ in arrived]
    to_ros, to_jaus, loop = [], [], []
    for stamp, received, published, angle in read_events(logs / "steering_controller.csv"):
        report = sent.get(int(stamp))
        if report is not None:
            to_ros.append(float(received) - report)
        place = bisect_right(times, float(published))
        if place < len(arrived) and abs(arrived[place][1] - float(angle)) <= QUANTUM:
            to_jaus.append(times[place] - float(published))
            if report is not None:
                loop.append(times[place] - report)
    return Latencies(latency_summary(to_ros), latency_summary(to_jaus), latency_summary(loop))


def counted(lines: Iterable[str], label: str) -> Counter[str]:
    """Returns the sums of `name=number` pairs on the lines that contain the label."""
    total: Counter[str] = Counter()
    for line in lines:
        if label in line:
            pairs = re.findall(r"([\w./-]+)=(\d+)", line.split(label, 1)[1])
            total.update({name: int(number) for name, number in pairs})
    return total


def report(logs: Path, output: Sequence[str], parameters: VehicleParameters) -> str:
    """Returns the tables of a run.

    Args:
        logs: Folder of the logs.
        output: Lines that the processes printed.
        parameters: Parameters of the vehicle and the scenario.

    Raises:
        ValueError: The logs hold no drive.
    """
    samples = driven(read_log(logs / "vehicle.csv"))
    path = StraightArcStraight.right_turn(parameters)
    error, ride = path_error(samples, path), comfort(samples, parameters)
    motion = Table("drive", "value", "unit")
    motion.add("duration", samples[-1].t - samples[0].t, "s")
    motion.add("path error, largest", error.maximum, "m")
    motion.add("path error, rms", error.rms, "m")
    motion.add("safe-region violations", 100 * ride.violation_fraction, "%")
    motion.add("peak lateral acceleration", ride.peak_lateral_acceleration, "m/s^2")
    motion.add("steering activity", total_variation(sample.delta for sample in samples), "rad")
    ways = latencies(logs)
    delay = Table("latency", "messages", "p50 ms", "p95 ms", "p99 ms", "max ms")
    for name, summary in (
        ("vehicle -> bridge -> ROS", ways.to_ros),
        ("ROS -> bridge -> vehicle", ways.to_jaus),
        ("whole loop", ways.loop),
    ):
        marks = (summary.p50, summary.p95, summary.p99, summary.maximum)
        delay.add(name, summary.count, *(1000 * mark for mark in marks))
    carried = Table("connection", "messages")
    for name, number in sorted(counted(output, "messages:").items()):
        carried.add(name, number)
    drops = Table("drop", "count")
    for name, number in sorted(counted(output, "drops:").items()):
        drops.add(name, number)
    return "\n\n".join(table.render() for table in (motion, delay, carried, drops))


def draw(logs: Path, target: Path, parameters: VehicleParameters) -> None:
    """Draws path and velocity over tyre angle.

    Raises:
        ValueError: The logs hold no drive.
    """
    samples = driven(read_log(logs / "vehicle.csv"))
    path = StraightArcStraight.right_turn(parameters)
    draw_run(samples, path, parameters, target, "Right-hand turn through the generated bridge")
