"""Log of a run and the numbers that judge it: path, comfort, activity, latency, closeness.

Logs are CSV files with one row per sample. Poses are those of the rear axle in ROS convention (x
forward, y left, yaw counter-clockwise), in metres, seconds and radians.
"""

from __future__ import annotations

import bisect
import csv
import math
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import TYPE_CHECKING

from .velocity import lateral_acceleration, safe_speed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path
    from types import TracebackType

    from .parameters import VehicleParameters
    from .path import StraightArcStraight


@dataclass(frozen=True)
class Sample:
    """One row of a log.

    Attributes:
        t: Time, s.
        x: Forward position, m.
        y: Left position, m.
        psi: Yaw, rad, counter-clockwise.
        v: Speed, m/s.
        delta: Tyre angle, rad; negative is right.
        delta_cmd: Tyre angle asked for, rad.
        v_cmd: Speed asked for, m/s.
    """

    t: float
    x: float
    y: float
    psi: float
    v: float
    delta: float
    delta_cmd: float
    v_cmd: float


COLUMNS = tuple(entry.name for entry in fields(Sample))
"""Columns of a log file, in order."""


class LogWriter:
    """Writes samples to a CSV file as they come; use it in a `with` statement."""

    def __init__(self, path: Path) -> None:
        """Opens the file anew and writes the header.

        Raises:
            OSError: The file cannot be written.
        """
        # The file outlives this call; close() and __exit__ end it.
        self._file = path.open("w", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file, lineterminator="\n")
        self._writer.writerow(COLUMNS)

    def write(self, sample: Sample) -> None:
        """Append one sample; numbers are written so that reading them back is exact."""
        self._writer.writerow([repr(float(getattr(sample, name))) for name in COLUMNS])

    def close(self) -> None:
        """Flush and close the file; closing twice is harmless."""
        self._file.close()

    def __enter__(self) -> LogWriter:
        """Returns the writer itself."""
        return self

    def __exit__(
        self,
        exception_type: type[BaseException] | None,
        exception: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Closes the file, whatever happened."""
        self.close()


def write_log(path: Path, samples: Iterable[Sample]) -> None:
    """Writes a whole log.

    Raises:
        OSError: The file cannot be written.
    """
    with LogWriter(path) as log:
        for sample in samples:
            log.write(sample)


def read_log(path: Path) -> list[Sample]:
    """Reads a log.

    Raises:
        OSError: The file cannot be read.
        ValueError: The header is another one, or a row is not eight finite numbers; names file and
            line.
    """
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.reader(file)
        if tuple(next(rows, ())) != COLUMNS:
            raise ValueError(f"{path}:1: header is not {','.join(COLUMNS)}")
        return [_sample(row, f"{path}:{rows.line_num}") for row in rows]


def _sample(row: list[str], where: str) -> Sample:
    try:
        values = [float(cell) for cell in row]
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    if len(values) != len(COLUMNS) or not all(map(math.isfinite, values)):
        raise ValueError(f"{where}: expected {len(COLUMNS)} finite numbers, got {','.join(row)}")
    return Sample(*values)


@dataclass(frozen=True)
class PathError:
    """Largest and root-mean-square distance (m) from the prescribed path."""

    maximum: float
    rms: float


def path_error(samples: Sequence[Sample], path: StraightArcStraight) -> PathError:
    """Returns the cross-track error of the rear axle over a run; samples weigh equally.

    Raises:
        ValueError: There are no samples.
    """
    _require(samples)
    errors = [path.cross_track_error(sample.x, sample.y) for sample in samples]
    return PathError(max(map(abs, errors)), root_mean_square(errors))


@dataclass(frozen=True)
class Comfort:
    """How a run relates to the safe region v^2 |tan delta| / L <= a_max.

    Attributes:
        violation_fraction: Share of the samples outside the region, 0 to 1.
        peak_lateral_acceleration: Largest v^2 |tan delta| / L, m/s^2.
        least_speed_margin: Smallest v_safe(delta) - v, m/s; negative once the region was left.
    """

    violation_fraction: float
    peak_lateral_acceleration: float
    least_speed_margin: float


def comfort(samples: Sequence[Sample], parameters: VehicleParameters) -> Comfort:
    """Judges a run against the safe region of `parameters`.

    Raises:
        ValueError: There are no samples.
    """
    _require(samples)
    sideways = [
        lateral_acceleration(sample.v, sample.delta, parameters.wheelbase) for sample in samples
    ]
    outside = sum(value > parameters.lateral_acceleration_limit for value in sideways)
    margin = min(safe_speed(sample.delta, parameters) - sample.v for sample in samples)
    return Comfort(outside / len(samples), max(sideways), margin)


def total_variation(values: Iterable[float]) -> float:
    """Returns the sum of the absolute changes of a signal, its activity, in its own unit."""
    return math.fsum(abs(later - earlier) for earlier, later in pairwise(values))


def root_mean_square(values: Sequence[float]) -> float:
    """Returns the root mean square of the values, in their unit; 0 for none."""
    if not values:
        return 0.0
    return math.sqrt(math.fsum(value * value for value in values) / len(values))


@dataclass(frozen=True)
class LatencySummary:
    """Percentiles of a list of latencies, in the unit of the list; NaN when it is empty."""

    count: int
    p50: float
    p95: float
    p99: float
    maximum: float


def latency_summary(latencies: Iterable[float]) -> LatencySummary:
    """Summarise latencies by nearest-rank percentiles: each is one of the measured values."""
    ordered = sorted(latencies)
    if not ordered:
        return LatencySummary(0, math.nan, math.nan, math.nan, math.nan)

    def rank(percent: int) -> float:
        # Integer ceiling: 0.95 * 100 in floating point may land above the exact rank.
        return ordered[-(-percent * len(ordered) // 100) - 1]

    return LatencySummary(len(ordered), rank(50), rank(95), rank(99), ordered[-1])


@dataclass(frozen=True)
class Gap:
    """Difference of two runs at equal times.

    Attributes:
        position: Largest distance between the vehicles, m.
        speed_rms: Root mean square of the difference of speed, m/s.
        steering_rms: Root mean square of the difference of tyre angle, rad.
        activity_ratio: Total variation of the second run's tyre angle over that of the first;
            infinite when only the second steers, 1 when neither does.
    """

    position: float
    speed_rms: float
    steering_rms: float
    activity_ratio: float


def gap(first: Sequence[Sample], second: Sequence[Sample]) -> Gap:
    """Compares two runs at the times of the first; the second is interpolated to them.

    Times that only one run covers are left out.

    Raises:
        ValueError: The runs do not overlap in time.
    """
    pairs = aligned(first, second)
    activity = total_variation(sample.delta for sample, _ in pairs)
    activity_second = total_variation(other.delta for _, other in pairs)
    if activity > 0.0:
        ratio = activity_second / activity
    else:
        ratio = math.inf if activity_second > 0.0 else 1.0
    return Gap(
        position=max(position_distance(one, two) for one, two in pairs),
        speed_rms=root_mean_square([one.v - two.v for one, two in pairs]),
        steering_rms=root_mean_square([one.delta - two.delta for one, two in pairs]),
        activity_ratio=ratio,
    )


def position_distance(one: Sample, two: Sample) -> float:
    """Returns the distance between the positions of two samples, m."""
    return math.hypot(one.x - two.x, one.y - two.y)


def closeness(
    first: Sequence[Sample],
    second: Sequence[Sample],
    tau: float,
    distance: Callable[[Sample, Sample], float] = position_distance,
) -> float:
    """Returns the smallest eps for which the runs are (tau, eps)-close.

    Every sample of each run then has a sample of the other within `tau` seconds in time and eps in
    value, both
    ways: the conformance notion of hybrid systems.

    Args:
        first: One run, ordered by time.
        second: The other run, ordered by time.
        tau: Tolerated shift in time, s; at least the sampling period if sampling times differ.
        distance: Distance of two samples; eps has its unit.

    Returns:
        eps; infinite when a sample has no counterpart within `tau`.
    """
    return max(_one_sided(first, second, tau, distance), _one_sided(second, first, tau, distance))


def _one_sided(
    these: Sequence[Sample],
    those: Sequence[Sample],
    tau: float,
    distance: Callable[[Sample, Sample], float],
) -> float:
    times = [sample.t for sample in those]
    worst = 0.0
    for sample in these:
        low = bisect.bisect_left(times, sample.t - tau)
        high = bisect.bisect_right(times, sample.t + tau)
        nearest = min((distance(sample, other) for other in those[low:high]), default=math.inf)
        worst = max(worst, nearest)
    return worst


def aligned(first: Sequence[Sample], second: Sequence[Sample]) -> list[tuple[Sample, Sample]]:
    """Returns the samples of one run with those of another, interpolated to the same times.

    Times that only one run covers are left out.

    Raises:
        ValueError: The runs do not overlap in time.
    """
    times = [sample.t for sample in second]
    pairs = []
    for sample in first:
        index = bisect.bisect_left(times, sample.t)
        if index < len(second) and times[index] == sample.t:
            pairs.append((sample, second[index]))
        elif 0 < index < len(second):
            pairs.append((sample, _between(second[index - 1], second[index], sample.t)))
    if not pairs:
        raise ValueError("the runs do not overlap in time")
    return pairs


def _between(earlier: Sample, later: Sample, time: float) -> Sample:
    share = (time - earlier.t) / (later.t - earlier.t)
    values = (
        getattr(earlier, name) + share * (getattr(later, name) - getattr(earlier, name))
        for name in COLUMNS[1:]
    )
    return Sample(time, *values)


class Table:
    """A table in plain text: numbers aligned right, words left, a rule below the heading."""

    def __init__(self, *headings: str) -> None:
        """Name the columns."""
        self._rows: list[tuple[str, ...]] = [headings]
        self._numeric = [True] * len(headings)

    def add(self, *cells: str | float) -> None:
        """Adds a row; an int or float is shown with four significant digits at most.

        Raises:
            ValueError: The number of cells is not the number of columns.
        """
        if len(cells) != len(self._numeric):
            raise ValueError(f"expected {len(self._numeric)} cells, got {len(cells)}")
        self._rows.append(tuple(_shown(cell) for cell in cells))
        for column, cell in enumerate(cells):
            self._numeric[column] = self._numeric[column] and not isinstance(cell, str)

    def render(self) -> str:
        """Returns the table, one line per row, without trailing blanks or a final newline."""
        widths = [max(map(len, column)) for column in zip(*self._rows, strict=True)]
        heading, *rows = [self._line(row, widths) for row in self._rows]
        return "\n".join([heading, "  ".join("-" * width for width in widths), *rows])

    def _line(self, row: tuple[str, ...], widths: list[int]) -> str:
        cells = (
            cell.rjust(width) if numeric else cell.ljust(width)
            for cell, width, numeric in zip(row, widths, self._numeric, strict=True)
        )
        return "  ".join(cells).rstrip()


def _shown(cell: str | float) -> str:
    if isinstance(cell, str):
        return cell
    return str(cell) if isinstance(cell, int) else f"{cell:.4g}"


def _require(samples: Sequence[Sample]) -> None:
    if not samples:
        raise ValueError("a run without samples cannot be judged")
