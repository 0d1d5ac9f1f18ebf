"""The figure of the stage: driven paths with their waypoints, and the active elements over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib import rc_context
from matplotlib.patches import Circle

from experiments.right_turn import style

from .results import TOLERANCE, Result, events, states

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .results import Event, State

HEIGHT = 2.9
"""Inches."""


def draw(folder: Path) -> Figure:
    """Draws what the stage has left.

    Args:
        folder: Folder of the stage.

    Raises:
        OSError: The drive `whole` of R has no data.
    """
    with rc_context(style.SETTINGS):
        figure = style.canvas(HEIGHT)
        path, times = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
        whole = Result.read(folder / "R" / "whole")
        _path(path, whole, folder)
        _times(times, whole, folder)
    return figure


def _path(axes: Axes, whole: Result, folder: Path) -> None:
    style.name_panel(axes, "a", "paths and waypoints")
    for number, (x, y) in enumerate(whole.waypoints, 1):
        circle = Circle(
            (x, y), TOLERANCE, facecolor="0.85", edgecolor=style.BLACK, linewidth=0.7, zorder=1
        )
        axes.add_patch(circle)
        axes.annotate(str(number), (x, y), xytext=(5, 4), textcoords="offset points")
    driven = states(folder / "R" / "whole")
    axes.plot(
        [each.x for each in driven],
        [each.y for each in driven],
        color=style.BLUE,
        label="R",
    )
    if (folder / "J" / "whole" / "result.json").exists():
        alone = states(folder / "J" / "whole")
        axes.plot(
            [each.x for each in alone],
            [each.y for each in alone],
            color=style.BLACK,
            linestyle=(0, (1.0, 3.0)),
            label="J",
        )
    axes.plot(driven[0].x, driven[0].y, "o", color=style.BLUE, markersize=3.5)
    if (folder / "R" / "emergency" / "result.json").exists():
        _emergency(axes, folder / "R" / "emergency")
    axes.margins(0.12)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x, forward at start (m)")
    axes.set_ylabel("y, left at start (m)")
    axes.legend(loc="center", bbox_to_anchor=(0.57, 0.52))


def _emergency(axes: Axes, folder: Path) -> None:
    driven = states(folder)
    axes.plot(
        [each.x for each in driven],
        [each.y for each in driven],
        color=style.VERMILION,
        linestyle=(0, (2.5, 1.2)),
        label="R, emergency",
    )
    axes.plot(driven[-1].x, driven[-1].y, "X", color=style.VERMILION, markersize=7, zorder=3)


def _times(axes: Axes, whole: Result, folder: Path) -> None:
    style.name_panel(axes, "b", "active element, as the operator is told")
    told, truth = events(folder / "R" / "whole"), states(folder / "R" / "whole")
    begin = _begin(told)
    _steps(axes, told, begin, truth, color=style.BLUE, label="R")
    passed = [each for each in whole.passages if each.nearest_time is not None]
    axes.plot(
        [each.nearest_time for each in passed],
        [each.number for each in passed],
        "o",
        color=style.BLACK,
        markersize=3.5,
        zorder=3,
        label="nearest to the waypoint",
    )
    stopped = folder / "R" / "emergency"
    if (stopped / "result.json").exists():
        result, told = Result.read(stopped), events(stopped)
        _steps(
            axes,
            told,
            _begin(told),
            states(stopped),
            color=style.VERMILION,
            linestyle=(0, (2.5, 1.2)),
            label="R, emergency",
        )
        if result.emergency is not None:
            axes.annotate(
                "emergency",
                (result.emergency, 1.5),
                xytext=(3, 0),
                textcoords="offset points",
                color=style.VERMILION,
            )
    axes.set_xlabel("time since ExecuteList (s)")
    axes.set_ylabel("active element")
    axes.set_yticks(range(len(whole.waypoints) + 1))
    axes.set_ylim(-0.4, len(whole.waypoints) + 1)
    axes.legend(loc="upper left")


def _begin(told: Sequence[Event]) -> float:
    return [each.time for each in told if each.kind == "execute"][-1]


def _steps(
    axes: Axes,
    told: Sequence[Event],
    begin: float,
    truth: Sequence[State],
    **look: object,
) -> None:
    """Draws the active element over time, from the begin of the list on."""
    active = [each for each in told if each.kind == "active" and each.time >= begin]
    times = [0.0, *(each.time - begin for each in active), truth[-1].time - begin]
    values = [0, *(each.value for each in active)]
    axes.stairs(values, times, baseline=None, linewidth=1.4, **look)
