"""The figure of a run: driven path, and speed over tyre angle against the safe region.

The only module of the example that needs matplotlib. It draws through `Figure` and an Agg canvas of
its own, so no backend is chosen for, and no state is kept in, the process that calls it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .metrics import Sample, comfort, path_error
from .velocity import safe_speed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection

    from .parameters import VehicleParameters
    from .path import StraightArcStraight

SIZE = (12.0, 5.6)
"""Width and height, inches."""
RESOLUTION = 120
"""Dots per inch."""

_TEXT = 12
_SMALL_TEXT = 10
_PRESCRIBED = "0.25"
_DRIVEN = "tab:blue"
_BOUNDARY = "tab:red"
_STATION_SPACING = 0.25
_AIR = 3.0
_SPEED_HEADROOM = 1.25
_CURVE_POINTS = 400


def draw_run(
    samples: Sequence[Sample],
    path: StraightArcStraight,
    parameters: VehicleParameters,
    target: Path,
    title: str,
) -> None:
    """Draw one run as a PNG with two panels.

    Left: prescribed path dashed and driven path solid, in metres with equal axes. On the right,
    speed over tyre angle with the safe speed solid and the limiter (comfort margin times safe
    speed) dotted; samples are coloured by time. The limits of the axes come from the path and the
    parameters, so that the figures of two runs of one scenario compare; they grow only where a run
    leaves them.

    Args:
        samples: The run, ordered by time.
        path: The prescribed path.
        parameters: Parameters of the safe region, the limiter and the limits of the axes.
        target: File to write.
        title: Headline of the figure.

    Raises:
        ValueError: There are no samples.
        OSError: The file cannot be written.
    """
    if not samples:
        raise ValueError("a run without samples cannot be drawn")
    # It takes half a second, and most who import this module draw nothing.
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    figure = Figure(figsize=SIZE, dpi=RESOLUTION, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, fontsize=_TEXT + 3)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _draw_path(left, samples, path)
    points = _draw_region(right, samples, parameters)
    bar = figure.colorbar(points, ax=right, pad=0.02)
    bar.set_label("time (s)", fontsize=_TEXT)
    bar.ax.tick_params(labelsize=_SMALL_TEXT)
    # No software version in the file: equal runs give equal bytes wherever matplotlib is the same.
    figure.savefig(target, format="png", metadata={"Software": None})


def _draw_path(axes: Axes, samples: Sequence[Sample], path: StraightArcStraight) -> None:
    prescribed = path.points(_STATION_SPACING)
    axes.plot(
        [sample.x for sample in samples],
        [sample.y for sample in samples],
        color=_DRIVEN,
        linewidth=2.5,
        label="driven (rear axle)",
    )
    axes.plot(
        [pose.x for pose in prescribed],
        [pose.y for pose in prescribed],
        color=_PRESCRIBED,
        linestyle="--",
        linewidth=1.5,
        label="prescribed",
    )
    axes.plot(samples[0].x, samples[0].y, "o", color=_DRIVEN, markersize=7, label="start")
    axes.plot(samples[-1].x, samples[-1].y, "s", color=_DRIVEN, markersize=7, label="end")
    axes.set_aspect("equal")
    axes.set_xlim(*_span([pose.x for pose in prescribed], [sample.x for sample in samples]))
    axes.set_ylim(*_span([pose.y for pose in prescribed], [sample.y for sample in samples]))
    _label(axes, "x, forward at start (m)", "y, left at start (m)")
    axes.legend(loc="lower left", fontsize=_SMALL_TEXT)
    error = path_error(samples, path)
    axes.set_title(
        f"Path: error at most {error.maximum:.2f} m, RMS {error.rms:.2f} m", fontsize=_TEXT
    )


def _span(prescribed: Sequence[float], driven: Sequence[float]) -> tuple[float, float]:
    """Returns the limits of an axis (m): the path's and some air, wider if the run leaves them."""
    low, high = min(prescribed) - _AIR, max(prescribed) + _AIR
    return min(low, min(driven) - 1.0), max(high, max(driven) + 1.0)


def _draw_region(
    axes: Axes, samples: Sequence[Sample], parameters: VehicleParameters
) -> PathCollection:
    limit = parameters.steering_limit
    top = max(
        _SPEED_HEADROOM * parameters.reference_speed, *(1.05 * sample.v for sample in samples)
    )
    angles = [limit * (2 * index / _CURVE_POINTS - 1) for index in range(_CURVE_POINTS + 1)]
    degrees = [math.degrees(angle) for angle in angles]
    # Near straight tyres the safe speed has no bound; the curve is cut a little above the panel.
    safe = [min(safe_speed(angle, parameters), 2 * top) for angle in angles]
    margin = parameters.comfort_margin
    bound = parameters.lateral_acceleration_limit
    axes.fill_between(degrees, safe, 2 * top, color=_BOUNDARY, alpha=0.1, linewidth=0)
    axes.plot(degrees, safe, color=_BOUNDARY, linewidth=2, label=f"safe speed, {bound:g} m/s\u00b2")
    axes.plot(
        degrees,
        [margin * speed for speed in safe],
        color=_BOUNDARY,
        linestyle=":",
        linewidth=2,
        label=f"limiter, {margin:g} of safe speed",
    )
    for side in (-1, 1):
        axes.text(
            side * 0.75 * degrees[-1],
            0.85 * top,
            "unsafe",
            ha="center",
            color=_BOUNDARY,
            fontsize=_TEXT,
        )
    points = axes.scatter(
        [math.degrees(sample.delta) for sample in samples],
        [sample.v for sample in samples],
        c=[sample.t for sample in samples],
        cmap="viridis",
        s=9,
        zorder=3,
        label="driven, coloured by time",
    )
    axes.set_xlim(math.degrees(-limit), math.degrees(limit))
    axes.set_ylim(0.0, top)
    _label(axes, "tyre angle (deg), negative is right", "speed (m/s)")
    axes.legend(loc="lower right", fontsize=_SMALL_TEXT)
    judged = comfort(samples, parameters)
    axes.set_title(
        f"Comfort: peak {judged.peak_lateral_acceleration:.2f} m/s\u00b2 sideways, "
        f"{100 * judged.violation_fraction:.1f} % unsafe",
        fontsize=_TEXT,
    )
    return points


def _label(axes: Axes, horizontal: str, vertical: str) -> None:
    axes.set_xlabel(horizontal, fontsize=_TEXT)
    axes.set_ylabel(vertical, fontsize=_TEXT)
    axes.tick_params(labelsize=_SMALL_TEXT)
    axes.grid(visible=True, alpha=0.3)
