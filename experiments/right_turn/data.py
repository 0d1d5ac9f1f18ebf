"""What a drive leaves behind, as a value and as a folder, and how much shall be driven.

A folder of a run holds `samples.csv` (the truth), `latencies.csv` (each message of each hop) and
`run.json` with everything else. Times are seconds on the one clock of the run.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from catvehicle.metrics import LatencySummary, Sample, latency_summary, read_log, write_log

HOPS = ("to_controller", "to_vehicle", "sense_act")
"""Ways whose time is measured: a report to the controller, a command to the vehicle, and the whole
way from the report to the command that answers it."""


STAGES = ("wall", "simulator")
"""Parts of the experiment, in their order; each has a folder of this name."""


@dataclass(frozen=True)
class Plan:
    """How much a stage of the experiment does.

    Attributes:
        quick: Whether a look at everything is enough, in the shortest time.
        runs: Drives of each system.
    """

    quick: bool = False
    runs: int = 10


@dataclass(frozen=True)
class Run:
    """One drive.

    Attributes:
        system: `J` (JAUS alone), `R` (ROS through the generated bridge), or the name of another.
        name: Name among the runs of the system; that of its folder.
        arrived: Whether the vehicle came to rest at the end of the path.
        samples: True states, ordered by time.
        latencies: Seconds that each message took, for each of `HOPS`.
        config: What was set: plain JSON values.
        metrics: Numbers that judge the drive, by name.
        counters: What was counted, by name.
    """

    system: str
    name: str
    arrived: bool
    samples: Sequence[Sample] = ()
    latencies: Mapping[str, Sequence[float]] = field(default_factory=dict)
    config: Mapping[str, Any] = field(default_factory=dict)
    metrics: Mapping[str, float] = field(default_factory=dict)
    counters: Mapping[str, int] = field(default_factory=dict)

    @property
    def latency(self) -> dict[str, LatencySummary]:
        """Percentiles (s) of each hop that carried a message."""
        return {hop: latency_summary(times) for hop, times in self.latencies.items() if times}

    def place(self, runs: Path) -> Path:
        """Returns the folder of the run among all runs."""
        return runs / self.system / self.name

    def write(self, folder: Path) -> None:
        """Writes the run into its folder, which is made when it is missing."""
        folder.mkdir(parents=True, exist_ok=True)
        write_log(folder / "samples.csv", self.samples)
        times = (
            (hop, duration) for hop, all_of_it in self.latencies.items() for duration in all_of_it
        )
        _write_rows(folder / "latencies.csv", ("hop", "seconds"), times)
        about = {
            "system": self.system,
            "name": self.name,
            "arrived": self.arrived,
            "config": dict(self.config),
            "metrics": {name: _finite(value) for name, value in self.metrics.items()},
            "latency": {hop: asdict(summary) for hop, summary in self.latency.items()},
            "counters": dict(self.counters),
        }
        text = json.dumps(about, indent=2, sort_keys=True, allow_nan=False)
        (folder / "run.json").write_text(text + "\n", encoding="utf-8")

    @classmethod
    def read(cls, folder: Path) -> Run:
        """Reads a run back; a metric that was not finite comes back as NaN.

        Raises:
            OSError: A file is missing.
            ValueError: A file is none that `write` has written.
        """
        about = json.loads((folder / "run.json").read_text(encoding="utf-8"))
        latencies: dict[str, list[float]] = {}
        for hop, seconds in _read_rows(folder / "latencies.csv", ("hop", "seconds")):
            latencies.setdefault(hop, []).append(float(seconds))
        metrics = about["metrics"].items()
        return cls(
            system=about["system"],
            name=about["name"],
            arrived=about["arrived"],
            samples=read_log(folder / "samples.csv"),
            latencies=latencies,
            config=about["config"],
            metrics={name: math.nan if value is None else value for name, value in metrics},
            counters=about["counters"],
        )


def read_all(runs: Path) -> list[Run]:
    """Reads every run below a folder, in the order of their places."""
    return [Run.read(path.parent) for path in sorted(runs.rglob("run.json"))]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _write_rows(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def _read_rows(path: Path, header: Sequence[str]) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        first, *rows = csv.reader(file)
    if tuple(first) != tuple(header):
        raise ValueError(f"{path}:1: header is not {','.join(header)}")
    return rows
