"""Drives systems in real time through the turn, several at once, and collects what they leave."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path

from catvehicle.evaluation import MOVING, counted, delays
from catvehicle.metrics import Sample, comfort, path_error, read_log, total_variation
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from catvehicle.progress import is_at_goal

from experiments.processes import ExperimentError, wait_until
from experiments.right_turn.data import Run
from experiments.right_turn.systems import OPERATOR, Running, Setting, Workspace

START_LIMIT = 60.0
"""Seconds in which the processes of systems must begin to exchange messages."""

DRIVE_LIMIT = 60.0
"""Seconds in which a drive of some 18 must be over."""

CREEP = 0.2
"""Speed in m/s below which the vehicle may be called arrived: the law slows it down for seconds."""


@dataclass(frozen=True)
class Drive:
    """A drive to be made.

    Attributes:
        workspace: The system.
        name: Name of the run.
        setting: Where and how it runs.
    """

    workspace: Workspace
    name: str
    setting: Setting


def drive(drives: Sequence[Drive], logs: Path) -> list[Run]:
    """Makes drives at the same time, begun at the same time.

    The operators are started when all else runs, so that no start disturbs a drive.

    Args:
        drives: Their settings have places of their own.
        logs: Folder for logs; those of drives that arrived are removed.

    Returns:
        The runs, in the order of the drives; their times count from the first motion.

    Raises:
        ExperimentError: A process ended, or controllers and vehicles did not find each other.
    """
    with ExitStack() as stack:
        systems = [
            stack.enter_context(
                Running(
                    planned_drive.workspace,
                    planned_drive.setting,
                    logs / planned_drive.workspace.system.name / planned_drive.name,
                )
            )
            for planned_drive in drives
        ]
        for system in systems:
            system.start_all()

        def check() -> None:
            for system in systems:
                system.check()

        if not wait_until(lambda: all(system.steps for system in systems), START_LIMIT, check):
            late = [system.workspace.system.name for system in systems if not system.steps]
            raise ExperimentError(
                f"no command in {START_LIMIT:.0f} s: {', '.join(late)}; see {logs}"
            )
        for system in systems:
            system.start_named(OPERATOR)
        wait_until(lambda: all(system.arrived for system in systems), DRIVE_LIMIT, check)
        for system in systems:
            system.stop()
        runs = [
            collect(planned_drive, system)
            for planned_drive, system in zip(drives, systems, strict=True)
        ]
    for run, system in zip(runs, systems, strict=True):
        if run.arrived:
            shutil.rmtree(system.logs)
    return runs


def collect(ended_drive: Drive, system: Running) -> Run:
    """Returns what a drive has left, whether or not it arrived; times are from the first motion."""
    samples = from_first_motion(read_log(system.logs / "vehicle.csv"))
    hop_delays = delays(system.logs)
    lines = [line for name in ended_drive.workspace.processes for line in system.lines(name)]
    return Run(
        system=ended_drive.workspace.system.name,
        name=ended_drive.name,
        arrived=bool(samples) and is_at_end(samples[-1]),
        samples=samples,
        latencies={
            "to_controller": hop_delays.to_controller,
            "to_vehicle": hop_delays.to_vehicle,
            "sense_act": hop_delays.loop,
        },
        config={**asdict(ended_drive.setting), "port": ended_drive.setting.port},
        metrics=judged(samples),
        counters=dict(counted(lines, "drops:")),
    )


def is_at_end(sample: Sample) -> bool:
    """Returns whether the vehicle stands, or creeps its last centimetres, at the path's end."""
    path = StraightArcStraight.right_turn(VehicleParameters())
    return sample.v < CREEP and is_at_goal(path, sample.x, sample.y)


def from_first_motion(samples: Sequence[Sample]) -> list[Sample]:
    """Returns a drive with times that count from its first motion.

    The first motion is where the speed crosses `MOVING`, between samples too, so that two drives
    are compared from the same event on and not from the starts of their processes.

    Returns:
        The samples from the one before that crossing on; none when there was no motion.
    """
    for index, sample in enumerate(samples):
        if sample.v > MOVING:
            first = max(index - 1, 0)
            before = samples[first]
            share = (MOVING - before.v) / (sample.v - before.v) if sample.v > before.v else 0.0
            begin = before.t + share * (sample.t - before.t)
            return [_shifted(later_sample, begin) for later_sample in samples[first:]]
    return []


def _shifted(sample: Sample, begin: float) -> Sample:
    _, *values = (getattr(sample, name) for name in sample.__dataclass_fields__)
    return Sample(sample.t - begin, *values)


def judged(
    samples: Sequence[Sample], parameters: VehicleParameters | None = None
) -> dict[str, float]:
    """Returns the numbers that judge one drive by itself; none when there was no motion.

    The drive ends where the vehicle has come to rest.
    """
    moving = [sample for sample in samples if sample.v > MOVING]
    if not moving:
        return {}
    parameters = parameters or VehicleParameters()
    path = StraightArcStraight.right_turn(parameters)
    whole = [sample for sample in samples if sample.t <= moving[-1].t]
    error, ride = path_error(whole, path), comfort(whole, parameters)
    return {
        "duration": whole[-1].t,
        "path_error_max": error.maximum,
        "path_error_rms": error.rms,
        "violation_fraction": ride.violation_fraction,
        "peak_lateral_acceleration": ride.peak_lateral_acceleration,
        "least_speed_margin": ride.least_speed_margin,
        "steering_activity": total_variation(sample.delta for sample in whole),
    }
