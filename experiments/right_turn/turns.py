"""The figure of the turn: paths, and speeds over tyre angles, of both systems on equal axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from catvehicle.metrics import Sample
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from catvehicle.velocity import safe_speed
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from experiments.right_turn import style

_MOST_POINTS = 90
_MOST_DOTS = 260
_STATION_SPACING = 0.5
_AIR = 3.0
_CURVE_POINTS = 200
_UNSAFE = style.VERMILION
_THIN = "0.55"


@dataclass(frozen=True)
class Turns:
    """What one row of the figure shows.

    Attributes:
        name: Name of the system.
        drives: All drives, each ordered by time, which counts from its first motion.
        chosen: Index of the drive in bold.
    """

    name: str
    drives: Sequence[Sequence[Sample]]
    chosen: int = 0

    def __post_init__(self) -> None:
        """Refuses what cannot be drawn."""
        if not self.drives or not all(self.drives):
            raise ValueError(f"{self.name}: a drive without samples cannot be drawn")


def draw(rows: Sequence[Turns], path: StraightArcStraight, parameters: VehicleParameters) -> Figure:
    """Returns a figure with a row of two panels for each system.

    Left the prescribed path dashed and the driven one solid; right speed over tyre angle with the
    boundary of the safe region solid, the limiter dotted and one drive coloured by time. All rows
    have the same axes.

    Args:
        rows: The systems.
        path: The prescribed path.
        parameters: Those of the safe region and the limiter.

    Raises:
        ValueError: A row has no drives.
    """
    with style.applied():
        figure = style.canvas(2.75 * len(rows))
        grid = figure.subplots(
            len(rows), 2, sharex="col", sharey="col", squeeze=False, width_ratios=(1.0, 1.25)
        )
        longest = max(drive[-1].t for row in rows for drive in row.drives)
        letters = iter("abcdefgh")
        dots = None
        for (left, right), row in zip(grid, rows, strict=True):
            style.name_panel(left, next(letters), row.name)
            count = f"{len(row.drives)} drive" + ("s" if len(row.drives) > 1 else "")
            style.name_panel(right, next(letters), f"the same {count}: speed over tyre angle")
            _draw_paths(left, row, path)
            dots = _draw_region(right, row, parameters, longest)
        grid[-1][0].set_xlabel("x, forward at the start (m)")
        grid[-1][1].set_xlabel("tyre angle (°), negative to the right")
        _limits(grid[0][0], rows, path)
        _limits_of_region(grid[0][1], rows, parameters)
        bar = figure.colorbar(dots, ax=list(grid[:, 1]), pad=0.02, aspect=40)
        bar.set_label("time since the first motion (s)")
        return figure


def _draw_paths(axes: Axes, row: Turns, path: StraightArcStraight) -> None:
    prescribed = path.points(_STATION_SPACING)
    for index, drive in enumerate(row.drives):
        if index != row.chosen:
            points = style.thinned(drive, _MOST_POINTS)
            axes.plot(*_xy(points), color=_THIN, linewidth=0.6)
    _name_others(axes, row)
    chosen = style.thinned(row.drives[row.chosen], 2 * _MOST_POINTS)
    axes.plot(*_xy(chosen), color=style.BLUE, linewidth=2.0, label="driven (rear axle)")
    axes.plot(
        [pose.x for pose in prescribed],
        [pose.y for pose in prescribed],
        color=style.BLACK,
        linestyle=(0, (5, 3)),
        linewidth=1.0,
        label="prescribed",
    )
    axes.plot(*_xy(chosen[:1]), "o", color=style.BLUE, markersize=4.5, label="start")
    axes.plot(*_xy(chosen[-1:]), "s", color=style.BLUE, markersize=4.5, label="end")
    axes.set_aspect("equal", adjustable="box")
    axes.set_ylabel("y, left at the start (m)")
    axes.legend(loc="lower left")


def _xy(samples: Sequence[Sample]) -> tuple[list[float], list[float]]:
    return [sample.x for sample in samples], [sample.y for sample in samples]


def _draw_region(
    axes: Axes, row: Turns, parameters: VehicleParameters, longest: float
) -> PathCollection:
    limit = parameters.steering_limit
    angles = [limit * (2 * index / _CURVE_POINTS - 1) for index in range(_CURVE_POINTS + 1)]
    degrees = [math.degrees(angle) for angle in angles]
    # Near straight tyres the safe speed has no bound; the curve is cut above the panel.
    ceiling = 4 * parameters.reference_speed
    safe = [min(safe_speed(angle, parameters), ceiling) for angle in angles]
    margin = parameters.comfort_margin
    bound = parameters.lateral_acceleration_limit
    axes.fill_between(
        degrees, safe, ceiling, facecolor="0.93", edgecolor="0.75", hatch="///", linewidth=0
    )
    axes.plot(degrees, safe, color=_UNSAFE, linewidth=1.6, label=f"boundary, {bound:g} m/s²")
    axes.plot(
        degrees,
        [margin * speed for speed in safe],
        color=_UNSAFE,
        linestyle=":",
        linewidth=1.4,
        label=f"limiter, {margin:g} of it",
    )
    for index, drive in enumerate(row.drives):
        if index != row.chosen:
            points = style.thinned(drive, _MOST_POINTS)
            axes.plot(*_angle_speed(points), color=_THIN, linewidth=0.6)
    _name_others(axes, row)
    drive = row.drives[row.chosen]
    points = style.thinned(drive, _MOST_DOTS)
    axes.plot(*_angle_speed(points), color="0.35", linewidth=1.0)
    dots = axes.scatter(
        *_angle_speed(points),
        c=[sample.t for sample in points],
        cmap=style.TIME_COLOURS,
        vmin=0.0,
        vmax=longest,
        s=7,
        linewidths=0,
        zorder=3,
    )
    axes.set_ylabel("speed (m/s)")
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
    for side in (-0.72, 0.72):
        axes.text(
            side * degrees[-1],
            1.06 * parameters.reference_speed,
            "unsafe",
            ha="center",
            va="center",
            color=_UNSAFE,
            bbox=box,
        )
    axes.text(0.5 * degrees[-1], 0.12 * parameters.reference_speed, "safe", ha="center")
    axes.legend(loc="lower left")
    return dots


def _name_others(axes: Axes, row: Turns) -> None:
    """Names the thin lines in the legend, if there are any."""
    if len(row.drives) > 1:
        axes.plot([], [], color=_THIN, linewidth=0.6, label=f"the other {len(row.drives) - 1}")


def _angle_speed(samples: Sequence[Sample]) -> tuple[list[float], list[float]]:
    return [math.degrees(sample.delta) for sample in samples], [sample.v for sample in samples]


def _limits(axes: Axes, rows: Sequence[Turns], path: StraightArcStraight) -> None:
    prescribed = path.points(_STATION_SPACING)
    driven = [sample for row in rows for drive in row.drives for sample in drive]
    xs = [pose.x for pose in prescribed] + [sample.x for sample in driven]
    ys = [pose.y for pose in prescribed] + [sample.y for sample in driven]
    axes.set_xlim(min(xs) - _AIR, max(xs) + _AIR)
    axes.set_ylim(min(ys) - _AIR, max(ys) + _AIR)


def _limits_of_region(axes: Axes, rows: Sequence[Turns], parameters: VehicleParameters) -> None:
    fastest = max(sample.v for row in rows for drive in row.drives for sample in drive)
    limit = math.degrees(parameters.steering_limit)
    axes.set_xlim(-limit, limit)
    axes.set_ylim(0.0, max(1.25 * parameters.reference_speed, 1.05 * fastest))
