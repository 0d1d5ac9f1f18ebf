"""Figures of what was swept: delay against loss, and the frequency of a bridge that polls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from catvehicle.metrics import total_variation
from matplotlib import colormaps, rc_context
from matplotlib.ticker import NullFormatter, StrMethodFormatter

from experiments.right_turn import style

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from catvehicle.metrics import Sample
    from catvehicle.path import StraightArcStraight
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_POINTS = 130
_LONGEST = 30.0
"""Seconds of a drive that are shown."""
_DARK = 0.6
"""Share of the colours' way from which on white letters are read better than black ones."""


@dataclass(frozen=True)
class Cell:
    """What one pair of delay and loss gave.

    Attributes:
        margin: Least of what was left to the boundary of the safe region, m/s.
        accepted: Whether all bounds were kept.
    """

    margin: float
    accepted: bool


def grid(
    cells: Mapping[tuple[float, float], Cell], *, label: str, horizontal: str, vertical: str
) -> Figure:
    """Returns a map of the smallest margin, with the boundary of what is accepted.

    Painted is how far drives went beyond the boundary, the farther the darker. A margin that was
    kept is not painted: a car that hardly drives keeps the largest.

    Args:
        cells: By horizontal and vertical place; both are shown as steps of equal width.
        label: What is painted, with unit.
        horizontal: Name of the first part of a place, with unit.
        vertical: Name of the second one.

    Raises:
        ValueError: There are no cells.
    """
    if not cells:
        raise ValueError("a map without cells cannot be drawn")
    columns = sorted({place[0] for place in cells})
    rows = sorted({place[1] for place in cells})
    with rc_context(style.SETTINGS):
        figure = style.canvas(2.9, 5.2)
        axes = figure.subplots()
        axes.grid(visible=False)
        values = [
            [_beyond(cells[x, y]) if (x, y) in cells else math.nan for x in columns] for y in rows
        ]
        most = max((each for row in values for each in row if math.isfinite(each)), default=0.0)
        most = most or 1.0
        image = axes.pcolormesh(values, cmap=colormaps["Blues"], vmin=0.0, vmax=most)
        for x, across in enumerate(columns):
            for y, up in enumerate(rows):
                if (across, up) in cells:
                    _write_cell(axes, x, y, cells[across, up], most)
        _draw_boundary(axes, cells, columns, rows)
        axes.set_xticks([x + 0.5 for x in range(len(columns))], [f"{x:g}" for x in columns])
        axes.set_yticks([y + 0.5 for y in range(len(rows))], [f"{y:g}" for y in rows])
        axes.tick_params(length=0)
        axes.set_xlabel(horizontal)
        axes.set_ylabel(vertical)
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.01), ncols=2, borderaxespad=0.0)
        figure.colorbar(image, ax=axes, pad=0.02).set_label(label)
        return figure


def _beyond(cell: Cell) -> float:
    """Returns how far a cell went beyond the boundary, m/s; NaN where that is not known."""
    return max(-cell.margin, 0.0) if math.isfinite(cell.margin) else math.nan


def _write_cell(axes: Axes, x: int, y: int, cell: Cell, most: float) -> None:
    if not math.isfinite(cell.margin):
        axes.text(x + 0.5, y + 0.5, "–", ha="center", va="center")
        return
    axes.text(
        x + 0.5,
        y + 0.5,
        _signed(cell.margin),
        ha="center",
        va="center",
        fontsize=7,
        color="white" if _beyond(cell) > _DARK * most else "black",
        fontweight="bold" if cell.margin < 0 else "normal",
    )


def _signed(margin: float) -> str:
    """Returns a margin with as many digits as it needs not to be a zero with a sign."""
    text = next(text for text in (f"{margin:.2f}", f"{margin:.3f}", f"{margin:.1g}", "0.00")
                if float(text) or not margin)  # fmt: skip
    return text.replace("-", "−")


def _draw_boundary(
    axes: Axes,
    cells: Mapping[tuple[float, float], Cell],
    columns: Sequence[float],
    rows: Sequence[float],
) -> None:
    """Draws a line wherever accepted cells meet others, and strikes the others through."""

    def accepted(x: int, y: int) -> bool | None:
        if not (0 <= x < len(columns) and 0 <= y < len(rows)):
            return None
        cell = cells.get((columns[x], rows[y]))
        return None if cell is None else cell.accepted

    xs: list[float] = []
    ys: list[float] = []
    for x in range(len(columns)):
        for y in range(len(rows)):
            for other, edge in (
                (accepted(x + 1, y), ((x + 1, x + 1), (y, y + 1))),
                (accepted(x, y + 1), ((x, x + 1), (y + 1, y + 1))),
            ):
                here = accepted(x, y)
                if here is not None and other is not None and here != other:
                    xs += [*edge[0], math.nan]
                    ys += [*edge[1], math.nan]
    axes.plot(
        xs,
        ys,
        color=style.VERMILION,
        linewidth=2.6,
        solid_capstyle="round",
        label="boundary of what is accepted",
    )
    failing = [
        (x + 0.12, y + 0.85)
        for x in range(len(columns))
        for y in range(len(rows))
        if accepted(x, y) is False
    ]
    axes.plot(
        [x for x, _ in failing],
        [y for _, y in failing],
        "x",
        color="white",
        markersize=4,
        markeredgewidth=2.2,
    )
    axes.plot(
        [x for x, _ in failing],
        [y for _, y in failing],
        "x",
        color=style.VERMILION,
        markersize=3.5,
        markeredgewidth=1.2,
        label="a bound is broken",
    )


@dataclass(frozen=True)
class Polled:
    """What a bridge did to the drive.

    Attributes:
        name: Name in the legend.
        frequency: Polls a second; None for a bridge that does not poll.
        drives: Drives, whose times count from the first motion; the first one is drawn.
        delays: Seconds from reports to the commands that answer them.
    """

    name: str
    frequency: float | None
    drives: Sequence[Sequence[Sample]]
    delays: Sequence[float]


def polling(
    bridges: Sequence[Polled], alone: Sequence[Sequence[Sample]], path: StraightArcStraight
) -> Figure:
    """Returns path, steering and delay of bridges that poll, beside one that does not.

    Args:
        bridges: The bridges.
        alone: Drives of JAUS alone.
        path: The prescribed path.
    """
    ordered = sorted(bridges, key=lambda each: each.frequency or math.inf)
    polls = [each for each in ordered if each.frequency is not None]
    shades = colormaps["cividis"]
    colours = {
        each.name: shades(place / max(len(polls) - 1, 1) * 0.9) for place, each in enumerate(polls)
    }
    with rc_context(style.SETTINGS):
        figure = style.canvas(5.0)
        panels = figure.subplots(2, 2)
        (course, angle), (activity, delay) = panels
        style.name_panel(course, "a", "path")
        style.name_panel(angle, "b", "tyre angle")
        style.name_panel(activity, "c", "steering activity")
        style.name_panel(delay, "d", "report to its answer")
        prescribed = path.points(0.5)
        for each in ordered:
            look = {"color": colours.get(each.name, style.VERMILION)}
            look["linestyle"] = "-" if each.frequency is not None else style.SYSTEM_LINES["R"]
            points = style.thinned(each.drives[0], _MOST_POINTS)
            course.plot([s.x for s in points], [s.y for s in points], label=each.name, **look)
            angles = [math.degrees(s.delta) for s in points]
            angle.plot([s.t for s in points], angles, label=each.name, **look)
        course.plot(
            [pose.x for pose in prescribed],
            [pose.y for pose in prescribed],
            color=style.BLACK,
            linestyle="--",
            linewidth=0.9,
            label="prescribed",
        )
        course.set_aspect("equal", adjustable="datalim")
        course.set_xlabel("x, forward at the start (m)")
        course.set_ylabel("y, left at the start (m)")
        course.legend(loc="lower left")
        angle.set_xlabel("time since the first motion (s)")
        angle.set_ylabel("tyre angle (°)")
        # The slowest polls go on for long; what there is to be seen is over before.
        angle.set_xlim(0.0, _LONGEST)
        _draw_activity(activity, ordered, alone, colours)
        _draw_delays(delay, ordered, colours)
        return figure


def _activity(drive: Sequence[Sample]) -> float:
    return math.degrees(total_variation(sample.delta for sample in drive))


def _draw_activity(
    axes: Axes,
    bridges: Sequence[Polled],
    alone: Sequence[Sequence[Sample]],
    colours: Mapping[str, object],
) -> None:
    polls = [each for each in bridges if each.frequency is not None]
    means = []
    for each in polls:
        values = [_activity(drive) for drive in each.drives]
        means.append(sum(values) / len(values))
        axes.plot(
            [each.frequency] * len(values),
            values,
            "o",
            color=colours[each.name],
            markersize=4,
            markeredgecolor="black",
            markeredgewidth=0.4,
            zorder=3,
        )
    frequencies = [each.frequency for each in polls]
    axes.plot(frequencies, means, color="0.4", linewidth=0.9, label="polls")
    for each in (each for each in bridges if each.frequency is None):
        mean = sum(map(_activity, each.drives)) / len(each.drives)
        axes.axhline(mean, color=style.VERMILION, ls=style.SYSTEM_LINES["R"], label=each.name)
    if alone:
        mean = sum(map(_activity, alone)) / len(alone)
        axes.axhline(mean, color=style.BLACK, linestyle=":", label=style.SYSTEM_NAMES["J"])
    axes.set_ylabel("sum of |change| of tyre angle (°)")
    _frequency_axis(axes, frequencies)
    axes.set_yscale("log")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    low, high = axes.get_ylim()
    axes.set_yticks([tick for tick in (20, 30, 50, 100, 200, 500, 1000) if low <= tick <= high])
    axes.legend(loc="upper right")


def _draw_delays(axes: Axes, bridges: Sequence[Polled], colours: Mapping[str, object]) -> None:
    polls = [each for each in bridges if each.frequency is not None and each.delays]
    frequencies = [each.frequency for each in polls]
    for share, marker, line, words in (
        (0.5, "o", "-", "median"),
        (0.99, "v", ":", "99 %"),
    ):
        values = [1000 * _rank(each.delays, share) for each in polls]
        axes.plot(frequencies, values, color="0.4", linestyle=line, linewidth=0.9, zorder=2)
        for each, value in zip(polls, values, strict=True):
            axes.plot(
                [each.frequency],
                [value],
                marker,
                color=colours[each.name],
                markersize=5,
                markeredgecolor="black",
                markeredgewidth=0.5,
                zorder=3,
            )
        axes.plot([], [], marker, color="0.4", linestyle=line, label=f"polls, {words}")
        for each in (each for each in bridges if each.frequency is None and each.delays):
            axes.axhline(
                1000 * _rank(each.delays, share),
                color=style.VERMILION,
                linestyle=line,
                label=f"{each.name}, {words}",
            )
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_ylabel("delay (ms)")
    _frequency_axis(axes, frequencies)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * 6)
    axes.legend(loc="upper right", ncols=2)


def _rank(values: Sequence[float], share: float) -> float:
    return sorted(values)[math.ceil(share * len(values)) - 1]


def _frequency_axis(axes: Axes, frequencies: Sequence[float | None]) -> None:
    axes.set_xscale("log")
    marks = [each for each in frequencies if each is not None]
    axes.set_xticks(marks, [f"{each:g}" for each in marks])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("polls a second (Hz)")
