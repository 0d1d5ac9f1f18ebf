"""What the stages found, gathered into one small value that the page and the table are made of."""

from __future__ import annotations

import json
import os
import platform
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING, Any

from catvehicle.evaluation import driven
from catvehicle.metrics import comfort, latency_summary, path_error, total_variation
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight

from experiments.right_turn.data import HOPS, Run, read_all
from experiments.right_turn.stages import STAGES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from catvehicle.metrics import Sample

FORMAT = 1
"""Version of the data."""


@dataclass(frozen=True)
class Measure:
    """A number that each drive has.

    Attributes:
        name: Name in the data.
        words: Name in tables.
        unit: Its unit.
        take: Works it out.
    """

    name: str
    words: str
    unit: str
    take: Callable[[Sequence[Sample]], float]


_PARAMETERS = VehicleParameters()
_PATH = StraightArcStraight.right_turn(_PARAMETERS)

MEASURES = (
    Measure("duration", "duration", "s", lambda drive: drive[-1].t - drive[0].t),
    Measure("path_max", "path error, largest", "m", lambda drive: path_error(drive, _PATH).maximum),
    Measure("path_rms", "path error, RMS", "m", lambda drive: path_error(drive, _PATH).rms),
    Measure(
        "unsafe",
        "samples outside the safe region",
        "%",
        lambda drive: 100 * comfort(drive, _PARAMETERS).violation_fraction,
    ),
    Measure(
        "sideways",
        "peak lateral acceleration",
        "m/s²",
        lambda drive: comfort(drive, _PARAMETERS).peak_lateral_acceleration,
    ),
    Measure(
        "margin",
        "least margin to the boundary",
        "m/s",
        lambda drive: comfort(drive, _PARAMETERS).least_speed_margin,
    ),
    Measure(
        "activity",
        "steering activity",
        "rad",
        lambda drive: total_variation(sample.delta for sample in drive),
    ),
)


def of_system(runs: Sequence[Run]) -> dict[str, Any]:
    """Returns what the drives of one system have in common: means, extremes, delays, counts.

    Args:
        runs: At least one.
    """
    moved = [each for each in map(_driven, runs) if each]
    measures = {
        each.name: _spread([each.take(samples) for samples in moved]) for each in MEASURES if moved
    }
    latency = {}
    for hop in HOPS:
        times = [each for run in runs for each in run.latencies.get(hop, ())]
        if times:
            summary = latency_summary(times)
            latency[hop] = {
                "count": summary.count,
                "p50": _rounded(summary.p50),
                "p95": _rounded(summary.p95),
                "p99": _rounded(summary.p99),
                "max": _rounded(summary.maximum),
            }
    return {
        "drives": len(runs),
        "arrived": sum(run.arrived for run in runs),
        "clock": runs[0].mode,
        "measures": measures,
        "latency": latency,
    }


def _driven(run: Run) -> list[Sample]:
    try:
        return driven(run.samples)
    except ValueError:
        return []


def _spread(values: Sequence[float]) -> dict[str, float]:
    return {
        "mean": _rounded(fmean(values)),
        "least": _rounded(min(values)),
        "most": _rounded(max(values)),
    }


def _rounded(value: float) -> float:
    """Returns a value with four digits: more would only be noise in the data that is kept."""
    return float(f"{value:.4g}")


def by_system(runs: Iterable[Run]) -> dict[str, list[Run]]:
    """Returns runs by the name of their system, in the order of their names."""
    found: dict[str, list[Run]] = {}
    for run in runs:
        found.setdefault(run.system, []).append(run)
    return found


def machine() -> dict[str, Any]:
    """Returns what the figures depend on, without the name of the computer."""
    return {
        "processors": os.cpu_count(),
        "architecture": platform.machine(),
        "python": platform.python_version(),
        "system": platform.system(),
    }


def summaries(folder: Path) -> dict[str, Any]:
    """Returns the summary of each stage that has one."""
    found = {}
    for stage in STAGES:
        path = folder / stage.name / "summary.json"
        if path.exists():
            found[stage.name] = json.loads(path.read_text(encoding="utf-8"))
    return found


def runs_of(folder: Path, stage: str) -> list[Run]:
    """Returns the drives that a stage kept; none when it was not run."""
    place = folder / stage
    return read_all(place) if place.exists() else []


def parameters() -> list[Mapping[str, Any]]:
    """Returns the parameters of vehicle and scenario, each with its source."""
    return [row._asdict() for row in VehicleParameters().describe()]
