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


LONGEST = 0.5
"""Seconds that a command may take on its way to be found again."""


@dataclass(frozen=True)
class Delays:
    """Seconds that each message took on its way.

    Attributes:
        to_controller: From the vehicle's report to the controller; through the bridge, if any.
        to_vehicle: From the controller's command to the vehicle's handler.
        loop: From the vehicle's report to the command that answers it, controller included.
    """

    to_controller: Sequence[float]
    to_vehicle: Sequence[float]
    loop: Sequence[float]


def driven(samples: Sequence[Sample]) -> list[Sample]:
    """Returns the part of a run from the first to the last motion.

    Raises:
        ValueError: The vehicle never moved.
    """
    moving = [index for index, sample in enumerate(samples) if sample.v > MOVING]
    if not moving:
        raise ValueError("the vehicle never moved")
    return list(samples[moving[0] : moving[-1] + 1])


def delays(logs: Path) -> Delays:
    """Matches the events of the vehicle and the steering controller on the machine's clock.

    Reports are matched by their time stamp (ms), commands by their value: the first arrival
    with the value that was published, which later ones hardly have while the vehicle steers.
    """
    vehicle = read_events(logs / "vehicle_events.csv")
    sent = {int(row[2]): float(row[1]) for row in vehicle if row[0] == "report"}
    arrived = [(float(row[1]), float(row[2])) for row in vehicle if row[0] == "command"]
    times = [time for time, _ in arrived]
    to_controller, to_vehicle, loop = [], [], []
    for stamp, received, published, angle in read_events(logs / "steering_controller.csv"):
        report = sent.get(int(stamp))
        if report is not None:
            to_controller.append(float(received) - report)
        begin, end = (bisect_right(times, float(published) + wait) for wait in (0.0, LONGEST))
        same = (time for time, value in arrived[begin:end] if abs(value - float(angle)) <= QUANTUM)
        time = next(same, None)
        if time is not None:
            to_vehicle.append(time - float(published))
            if report is not None:
                loop.append(time - report)
    return Delays(to_controller, to_vehicle, loop)


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
    ways = delays(logs)
    delay = Table("latency", "messages", "p50 ms", "p95 ms", "p99 ms", "max ms")
    for name, times in (
        ("vehicle -> bridge -> ROS", ways.to_controller),
        ("ROS -> bridge -> vehicle", ways.to_vehicle),
        ("whole loop", ways.loop),
    ):
        summary = latency_summary(times)
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
