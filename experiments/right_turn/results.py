"""What the stages found, gathered into one small value that the page and the table are made of."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

from catvehicle.metrics import latency_summary

from experiments.right_turn.data import HOPS, STAGES, Run, read_all

FORMAT = 1
"""Version of the data."""

QUIET_SHARE = 0.5
"""Processes that want a processor, for each there is, up to which a computer is quiet."""


class Measure(NamedTuple):
    """A metric of drives that tables show.

    Attributes:
        name: Name among the metrics of a run.
        words: Name in tables.
        unit: Unit in tables.
        factor: What a metric is multiplied with for it.
    """

    name: str
    words: str
    unit: str
    factor: float = 1.0


MEASURES = (
    Measure("duration", "duration", "s"),
    Measure("path_error_max", "path error, largest", "m"),
    Measure("path_error_rms", "path error, RMS", "m"),
    Measure("violation_fraction", "outside the safe region", "% of the samples", 100.0),
    Measure("peak_lateral_acceleration", "peak lateral acceleration", "m/s²"),
    Measure("least_speed_margin", "least margin to the boundary", "m/s"),
    Measure("steering_activity", "steering activity", "°", math.degrees(1.0)),
)


def of_system(runs: Sequence[Run]) -> dict[str, Any]:
    """Returns what the drives of one system have in common: means, extremes, delays, counts.

    Args:
        runs: At least one.
    """
    latency = {}
    for hop in HOPS:
        times = [duration for run in runs for duration in run.latencies.get(hop, ())]
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
        "measures": measures([run.metrics for run in runs]),
        "latency": latency,
    }


def measures(metrics: Sequence[Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """Returns mean and extremes of each measure, in the unit of the tables.

    Args:
        metrics: Those of each drive.
    """
    spreads = {}
    for measure in MEASURES:
        values = [
            measure.factor * values[measure.name] for values in metrics if measure.name in values
        ]
        if values:
            spreads[measure.name] = _spread(values)
    return spreads


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
    runs_by_system: dict[str, list[Run]] = {}
    for run in runs:
        runs_by_system.setdefault(run.system, []).append(run)
    return runs_by_system


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
    summaries_by_stage = {}
    for stage in STAGES:
        path = folder / stage / "summary.json"
        if path.exists():
            summaries_by_stage[stage] = json.loads(path.read_text(encoding="utf-8"))
    return summaries_by_stage


def runs_of(folder: Path, stage: str) -> list[Run]:
    """Returns the drives that a stage kept; none when it was not run."""
    place = folder / stage
    return read_all(place) if place.exists() else []
