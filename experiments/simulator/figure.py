"""The figure of the stage: events over real time while the pace stays and changes, and the path."""

from __future__ import annotations

from bisect import bisect_left
from pathlib import Path

from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.right_turn import style

from .results import RATE, Result, arrivals, states

HEIGHT = 2.75
"""Inches."""
WINDOW = 0.5
"""Seconds of real time over which a rate is counted."""
SHOWN = 8.0
"""Seconds of real time in which events are counted."""

_LOOKS = {
    "double": (style.VERMILION, "-", "2×"),
    "real": (style.BLACK, "-", "1×"),
    "half": (style.BLUE, "-", "0.5×"),
    "wall_clock": (style.SKY, (0, (1, 1.2)), "0.5×, control"),
}
"""Colour, line and name of the runs whose pace stays."""


def draw(folder: Path) -> Figure:
    """Draws what the stage has left.

    Args:
        folder: Folder of the stage.

    Raises:
        OSError: A run has no data.
    """
    names = [name for name in _LOOKS if (folder / name / "result.json").exists()]
    with style.applied():
        figure = style.canvas(HEIGHT)
        if not (folder / "changing" / "result.json").exists():
            counts, errors = figure.subplots(1, 2)
        else:
            counts, rates, errors = figure.subplots(1, 3)
            _rates(rates, folder / "changing")
        _counts(counts, folder, names)
        _errors(errors, folder, [name for name in names if name != "wall_clock"])
    return figure


def _counts(axes: Axes, folder: Path, names: list[str]) -> None:
    style.name_panel(axes, "a", "events while the pace stays")
    for name in names:
        result = Result.read(folder / name)
        segment = result.segments[0]
        times = [arrival.received for arrival in arrivals(folder / name)]
        times = [time - segment.begin for time in times if time >= segment.begin]
        times = [time for time in times if time <= SHOWN]
        colour, line, words = _LOOKS[name]
        label = f"{words}: {segment.real_rate:.1f}/s"
        axes.plot(times, range(1, len(times) + 1), color=colour, linestyle=line, label=label)
    axes.set_xlabel("real time (s)")
    axes.set_ylabel("events received")
    axes.set_xlim(0, SHOWN)
    # Room for the legend above the fastest.
    axes.set_ylim(0, 3.2 * RATE * SHOWN)
    axes.legend(loc="upper left")


def _rates(axes: Axes, folder: Path) -> None:
    style.name_panel(axes, "b", "rate while the pace changes")
    times = [arrival.received for arrival in arrivals(folder)]
    segments = Result.read(folder).segments
    begin, end = segments[0].begin, segments[-1].end
    looked = [begin + WINDOW + at * 0.05 for at in range(int((end - begin - WINDOW) / 0.05))]
    rates = [
        (bisect_left(times, moment) - bisect_left(times, moment - WINDOW)) / WINDOW
        for moment in looked
    ]
    factors = [segment.factor for segment in segments]
    edges = [segment.begin - begin for segment in segments] + [end - begin]
    asked = [RATE * factor for factor in factors]
    axes.stairs(
        asked,
        edges,
        baseline=None,
        color=style.ORANGE,
        linewidth=3.5,
        alpha=0.8,
        label=f"{RATE:g}/s × pace that was set",
    )
    axes.plot(
        [moment - begin - WINDOW / 2 for moment in looked],
        rates,
        color=style.BLUE,
        linewidth=1.0,
        label=f"received in {WINDOW:g} s",
    )
    for segment in segments:
        middle = (segment.begin + segment.end) / 2 - begin
        axes.text(middle, RATE * segment.factor + 2.2, f"{segment.factor:g}×", ha="center")
    axes.set_xlabel("real time (s)")
    axes.set_ylabel("events in a real second (1/s)")
    axes.set_ylim(0, 3 * RATE)
    axes.legend(loc="upper left")


def _errors(axes: Axes, folder: Path, names: list[str]) -> None:
    style.name_panel(axes, "c", "distance from the path")
    path = StraightArcStraight.right_turn(VehicleParameters())
    lines = {"double": (0, (1, 1.2)), "half": (0, (4, 1.5))}
    for name in names:
        nearest = [path.nearest(state.x, state.y) for state in states(folder / name)[::5]]
        colour, _, words = _LOOKS[name]
        axes.plot(
            [point.station for point in nearest],
            [point.cross_track_error for point in nearest],
            color=colour,
            linestyle=lines.get(name, "-"),
            label=words,
        )
    axes.set_xlabel("way along the path (m)")
    axes.set_ylabel("to the left of the path (m)")
    axes.legend(loc="upper right")
