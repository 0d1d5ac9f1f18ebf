"""Figures in which drives of both systems lie on each other: delays, steering, distance in time."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple
from itertools import combinations, pairwise, product
from statistics import median

from catvehicle.metrics import Sample, total_variation
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.right_turn import style
from experiments.right_turn.tables import number

_MOST_POINTS = 130
_STEP = 0.1
"""Seconds between two places at which drives are compared."""

HOP_NAMES = {
    "to_controller": "report to controller",
    "to_vehicle": "command to vehicle",
    "sense_act": "report to its answer",
}


def latencies(hops: Mapping[str, Mapping[str, Sequence[float]]]) -> Figure:
    """Returns the distributions of the delay on each way.

    Args:
        hops: Seconds that messages took, by way and by system.

    Raises:
        ValueError: No message was measured.
    """
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: PLC0415 - as in style

    shown = {
        hop: {system: times for system, times in systems.items() if times}
        for hop, systems in hops.items()
        if any(systems.values())
    }
    if not shown:
        raise ValueError("no message was measured")
    with style.applied():
        figure = style.canvas(2.5)
        panels = figure.subplots(1, len(shown), sharey=True, squeeze=False)[0]
        for axes, letter, (hop, systems) in zip(panels, "abc", shown.items(), strict=False):
            style.name_panel(axes, letter, HOP_NAMES.get(hop, hop))
            for system, times in systems.items():
                _distribution(axes, system, times)
            axes.set_xscale("log")
            axes.xaxis.set_minor_locator(LogLocator(subs="auto"))
            axes.xaxis.set_minor_formatter(NullFormatter())
            axes.set_xlabel("delay (ms)")
            axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.legend(loc="upper left", title="delay in ms", title_fontsize=7)
        panels[0].set_ylabel("share of messages")
        panels[0].set_ylim(0.0, 1.5)
        panels[0].set_yticks([0.0, 0.25, 0.5, 0.75, 1.0])
        return figure


def _distribution(axes: Axes, system: str, times: Sequence[float]) -> None:
    ordered = sorted(1000.0 * time for time in times)
    ranks = range(len(ordered))
    points = style.thinned([(ordered[rank], (rank + 1) / len(ordered)) for rank in ranks], 250)
    xs, ys = [x for x, _ in points], [y for _, y in points]
    look = style.look(system)
    middle, tail = (ordered[math.ceil(share * len(ordered)) - 1] for share in (0.5, 0.99))
    words = f"{system}, median {number(middle)}, 99 % {number(tail)}"
    axes.step(xs, ys, where="post", label=words, **look)
    axes.plot([tail], [0.99], "v", color=look["color"], markersize=4.5, markeredgecolor="black")


def steering(drives: Mapping[str, Sequence[Sequence[Sample]]]) -> Figure:
    """Returns tyre angles over time, what they sum up to, and that sum for each drive.

    Args:
        drives: Drives by system; their times count from the first motion.
    """
    with style.applied():
        figure = style.canvas(2.5)
        angle, activity, sums = figure.subplots(1, 3, width_ratios=(1.25, 1.25, 0.8))
        style.name_panel(angle, "a", "tyre angle")
        style.name_panel(activity, "b", "steering activity")
        style.name_panel(sums, "c", "of each drive")
        for place, (system, all_drives) in enumerate(drives.items()):
            look = style.look(system)
            for index, drive in enumerate(all_drives):
                first = index == 0
                weight = {**look, "linewidth": 1.5 if first else 0.4, "alpha": 1 if first else 0.6}
                points = style.thinned(drive, _MOST_POINTS)
                times = [sample.t for sample in points]
                angles = [math.degrees(sample.delta) for sample in points]
                angle.plot(times, angles, label=system if first else None, **weight)
                activity.plot(*_summed(drive), label=system if first else None, **weight)
            totals = [
                math.degrees(total_variation(sample.delta for sample in drive))
                for drive in all_drives
            ]
            _dots(sums, place, totals, look["color"])
        angle.set_ylabel("tyre angle (°)")
        activity.set_ylabel("sum of |change| (°)")
        sums.set_ylabel("sum of |change| (°)")
        # From zero on, as beside it: a cut axis would make a hundredth look wild.
        sums.set_ylim(activity.get_ylim())
        for axes in (angle, activity):
            axes.set_xlabel("time since the first motion (s)")
            axes.legend(loc="lower right")
        sums.set_xticks(range(len(drives)), list(drives))
        sums.set_xlim(-0.6, len(drives) - 0.4)
        return figure


def _summed(drive: Sequence[Sample]) -> tuple[list[float], list[float]]:
    total, points = 0.0, [(0.0, 0.0)]
    for before, after in pairwise(drive):
        total += abs(math.degrees(after.delta - before.delta))
        points.append((after.t, total))
    kept = style.thinned(points, _MOST_POINTS)
    return [time for time, _ in kept], [value for _, value in kept]


def _dots(axes: Axes, place: int, values: Sequence[float], colour: str) -> None:
    """Draws a dot for each value, spread so that equal ones are seen, and their mean as a line."""
    count = len(values)
    spread = [place + 0.36 * ((index + 0.5) / count - 0.5) for index in range(count)]
    axes.plot(spread, values, "o", color=colour, markersize=3.5, markeredgewidth=0.4, mec="black")
    mean = sum(values) / count
    axes.plot([place - 0.32, place + 0.32], [mean, mean], color="black", linewidth=1.2)
    axes.annotate(
        f"{mean:.2f}",
        (place, min(values)),
        xytext=(0, -6),
        textcoords="offset points",
        ha="center",
        va="top",
    )


def gaps(first: Sequence[Sequence[Sample]], second: Sequence[Sequence[Sample]]) -> Figure:
    """Returns how far two drives are apart over time: J from J beside R from J.

    Args:
        first: Drives of J, at least two; times count from the first motion.
        second: Drives of R.
    """
    null = list(combinations(first, 2))
    both = list(product(first, second))
    with style.applied():
        figure = style.canvas(2.5)
        panels = figure.subplots(1, len(_QUANTITIES))
        for axes, letter, (name, (label, take)) in zip(
            panels, "abc", _QUANTITIES.items(), strict=True
        ):
            style.name_panel(axes, letter, f"difference in {name}")
            for system, pairs, words in (("R", both, "R from J"), ("J", null, "J from J")):
                curves = [_difference(one, two, take) for one, two in pairs]
                _band(axes, system, curves, words)
            axes.set_ylim(bottom=0.0)
            low, high = axes.get_ylim()
            axes.set_ylim(low, 1.45 * high)
            axes.set_xlabel("time since the first motion (s)")
            axes.set_ylabel(label)
            axes.legend(loc="upper left")
        return figure


def _apart(one: Sample, two: Sample) -> float:
    return math.hypot(one.x - two.x, one.y - two.y)


_QUANTITIES = {
    "position": ("distance (m)", _apart),
    "speed": ("difference (m/s)", lambda one, two: abs(one.v - two.v)),
    "angle": ("difference (°)", lambda one, two: math.degrees(abs(one.delta - two.delta))),
}


def _difference(
    one: Sequence[Sample], two: Sequence[Sample], take: Callable[[Sample, Sample], float]
) -> list[float]:
    """Returns a quantity at every step of time that both drives cover."""
    count = int(min(one[-1].t, two[-1].t) / _STEP)
    pairs = zip(_stepped(one, count), _stepped(two, count), strict=True)
    return [take(here, there) for here, there in pairs]


def _stepped(drive: Sequence[Sample], count: int) -> list[Sample]:
    """Returns states at each step of time since the first motion, linear between samples."""
    times = [sample.t for sample in drive]
    states = []
    for step in range(count):
        place = min(max(bisect_right(times, step * _STEP), 1), len(drive) - 1)
        before, after = drive[place - 1], drive[place]
        share = (step * _STEP - times[place - 1]) / (after.t - before.t)
        values = zip(astuple(before), astuple(after), strict=True)
        states.append(Sample(*(early + share * (late - early) for early, late in values)))
    return states


def _band(axes: Axes, system: str, curves: Sequence[Sequence[float]], words: str) -> None:
    """Draws the median of curves, and between which values all of them lie."""
    length = min(map(len, curves))
    columns = [sorted(curve[step] for curve in curves) for step in range(length)]
    times = [step * _STEP for step in range(length)]
    look = style.look(system)
    axes.fill_between(
        times,
        [column[0] for column in columns],
        [column[-1] for column in columns],
        color=look["color"],
        alpha=0.25,
        linewidth=0,
    )
    middle = [median(column) for column in columns]
    axes.plot(times, middle, label=f"{words}, {len(curves)} pairs", **look)
