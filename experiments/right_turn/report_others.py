"""The parts of the page beside the turn itself: closeness, sweeps, polls, faults, simulators."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from experiments.right_turn.tables import answer, figure, markdown_table, number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


def controls(data: Mapping[str, Any]) -> Iterator[str]:
    """Yields what must be told from J."""
    found = data["summaries"].get("wall", {}).get("controls")
    if not found:
        return
    yield "### What must be told from J\n"
    rows = [
        (
            each["about"],
            each["drives"],
            "yes" if each["differs"] else "**no**",
            "; ".join(each["by"]),
        )
        for each in found.values()
    ]
    yield markdown_table(("drives in real time", "", "shown to be different", "by"), rows)


def closeness(data: Mapping[str, Any]) -> Iterator[str]:
    """Yields what the paper's word *bi-similar* becomes."""
    if not data["closeness"]:
        return
    yield "### What becomes of the paper's claim\n"
    yield (
        'The paper calls the two drives "sufficiently bi-similar". Here that is a pair of numbers: '
        "drives are bi-similar up to (τ, ε) when each state of one has a state of the other within "
        "τ seconds and ε, both ways. The smallest ε of all pairs of J and R, in real time:\n"
    )
    rows = [
        (f"{row['shift']:g}", row["position"], row["speed"], row["angle"])
        for row in data["closeness"]
    ]
    yield markdown_table(("τ, s", "ε of position, m", "of speed, m/s", "of tyre angle, rad"), rows)


def parts(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    """Yields the parts.

    Args:
        data: Results as `gather` returns them.
        figures: Folder of the figures, as seen from the page.
    """
    yield from _sweep(data, figures)
    yield from _polling(data, figures)
    yield from _faults(data)
    yield from _simulator(data, figures)
    yield from _waypoints(data, figures)


_BOUNDS = {
    "violation_fraction": "unsafe, share",
    "path_error_excess": "path error beyond J, m",
    "gap_position": "gap, m",
    "gap_speed_rms": "speed, RMS m/s",
    "gap_steering_rms": "angle, RMS rad",
    "closeness_100ms": "ε at 0.1 s, m",
    "activity_ratio": "steering, times J",
}
"""Words of the bounds of the sweep."""

_GROUPS = {
    ("nominal", "null"): "nothing added; J with another seed is what cannot be told apart",
    ("control",): "what must be refused",
    ("way", "J"): "one way delayed, and J with the delay on both",
    ("fault",): "jitter, order, repetition, bursts of losses",
    ("rate",): "other rates of the reports",
}
"""Groups of cells of the sweep that have a table."""

_REMARKS = {
    ("fault",): (
        "Where packets overtake each other, R bears less than J. Its speed and its tyre angle are "
        "two streams of SetWrenchEffort from one bridge to one vehicle, and a vehicle that obeys "
        "no command older than the last one of its sender drops the one that was overtaken "
        "(`component.out_of_order`). J sends both in one message. A ROS topic that holds both, "
        "or a join of the two, would do the same for R.\n"
    ),
}
"""What is to be said below the table of a group."""


def _sweep(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("sweep")
    if not found:
        return
    yield "## What it bears\n"
    yield (
        "In virtual time the ways between vehicle and bridge delay and lose what they are told "
        "to. Each cell is driven with several seeds, which set the phases between the processes, "
        "and compared with J that meets nothing; the worst drive counts. A cell is accepted when "
        "every bound is kept.\n"
    )
    yield figure("map", figures, "Least safety margin over delay and loss", data)
    yield (
        "The number in a cell is the least margin to the boundary of the safe region, in speed; "
        "below zero the vehicle was outside. Delay is added on each way, so the loop has it "
        "twice.\n"
    )
    names = [name for name in found["bounds"] if name in _BOUNDS]
    head = ("cell", "system", *(_BOUNDS[name] for name in names), "margin, m/s", "accepted")
    bounds = ("*bound*", "", *(number(found["bounds"][name]) for name in names), "", "")
    for group, words in _GROUPS.items():
        cells = [cell for cell in found["cells"] if cell["group"] in group]
        if cells:
            yield f"{words[0].upper()}{words[1:]}:\n"
            rows = [_cell(cell, names) for cell in cells]
            yield markdown_table(head, [bounds, *rows])
            if group in _REMARKS:
                yield _REMARKS[group]
    if found["limits"]:
        yield "Where it breaks, found by bisection:\n"
        rows = [
            (each["way"], each["criterion"], each["holds"], each["breaks"], each["unit"])
            for each in found["limits"]
        ]
        yield markdown_table(("way", "criterion", "still holds at", "breaks at", ""), rows)


def _cell(cell: Mapping[str, Any], names: Sequence[str]) -> tuple[object, ...]:
    values = (
        f"**{number(cell['most'].get(name))}**"
        if name in cell["broken"]
        else number(cell["most"].get(name))
        for name in names
    )
    accepted = "yes" if cell["accepted"] else "no"
    if cell["arrived"] < cell["drives"]:
        accepted += f", {cell['arrived']} of {cell['drives']} arrived"
    margin = number(cell["least_speed_margin"])
    return (cell["name"].replace("-", " "), cell["system"], *values, margin, accepted)


def _polling(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("polling")
    if not found:
        return
    yield "## A bridge that polls\n"
    yield (
        "The text of the paper has a bridge that runs at a frequency given when it is started. "
        "This is such a bridge, as far as the text tells it: the same models and translations, "
        "but what arrives on either side waits for the next poll, and only the newest is carried. "
        "It is driven in virtual time beside the generated one, which passes messages as they "
        "come. A vehicle that stops when it hears nothing for 0.2 s hardly moves behind slow "
        "polls, so there it is driven with more patience too, to see the delay alone.\n"
    )
    yield figure("polling", figures, "Path, steering and delay of bridges that poll", data)
    head = (
        *("bridge", "patience, s", "arrived", "report to answer, median ms", "99 %, ms"),
        *("path error, m", "steering, °", "margin, m/s"),
    )
    yield markdown_table(head, [_polled(cell) for cell in found["cells"]])


def _polled(cell: Mapping[str, Any]) -> tuple[object, ...]:
    most = cell["most"]
    delays = (most.get(name) for name in ("sense_act_p50", "sense_act_p99"))
    activity = most.get("steering_activity")
    return (
        f"polls at {cell['frequency']} Hz" if "frequency" in cell else "generated",
        number(cell.get("patience")),
        f"{cell['arrived']} of {cell['drives']}",
        *("" if each is None else number(1000 * each) for each in delays),
        number(most.get("path_error_max")),
        "" if activity is None else number(math.degrees(activity)),
        number(cell["least_speed_margin"]),
    )


def _faults(data: Mapping[str, Any]) -> Iterator[str]:
    found = {
        words: data["summaries"][name]
        for name, words in (("stress", "real time"), ("stress_virtual", "virtual time"))
        if name in data["summaries"]
    }
    if not found:
        return
    yield "## When something fails\n"
    for words, summary in found.items():
        yield f"In {words}:\n"
        rows = [(claim["text"], answer(claim)) for claim in summary.get("claims", ())]
        yield markdown_table(("what must hold", "holds"), rows)
        values = list(_values({name: each for name, each in summary.items() if name != "claims"}))
        if values:
            yield markdown_table(("measured", ""), values)


def _values(found: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    """Yields the numbers of a summary, however deep they stand, with their place in words."""
    for name, value in found.items():
        words = f"{before}{name.replace('_', ' ')}"
        if isinstance(value, dict):
            yield from _values(value, f"{words}, ")
        elif not isinstance(value, list):
            yield words, number(value)


def _waypoints(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("waypoints")
    if not found:
        return
    yield "## A robot along waypoints\n"
    yield (
        "Another robot and other services: an operator unit gives a list of waypoints to a robot "
        "with differential drive, whose controller is a ROS node behind ready maps. Each waypoint "
        f"must be passed within {number(found['tolerance_m'])} m.\n"
    )
    yield figure("waypoints", figures, "Path along waypoints, and the active element", data)
    rows = [
        (
            name.replace("_", " "),
            len(run["waypoints"]),
            number(run["duration"]),
            number(run["stop_time"]),
            number(run["drift"]),
            "yes" if all(run["claims"].values()) else "**no**",
        )
        for name, run in found["runs"].items()
    ]
    head = ("drive", "waypoints", "duration, s", "stopped after, s", "moved then, m", "as it must")
    yield markdown_table(head, rows)


def _simulator(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("simulator")
    if not found:
        return
    yield "## Beside a simulator\n"
    yield (
        "The plant is a process of its own that speaks ROS topics in its own time, as Gazebo does "
        "([how](how-to/simulators.md)), and a JAUS unit behind the bridge asks for "
        f"{found['rate']:g} reports a second. They follow the time of the simulation:\n"
    )
    yield figure("simulator", figures, "Rate of JAUS events over the pace of the simulation", data)
    rows = [
        (
            name.replace("_", " "),
            "the simulation" if run["follows_clock"] else "the wall",
            number(segment["pace"]),
            number(segment["real_rate"]),
            number(segment["simulated_rate"]),
            "yes" if run["follows"] else "no",
        )
        for name, run in found["runs"].items()
        for segment in run["segments"]
    ]
    head = (
        "run",
        "clock of the bridge",
        "pace",
        "reports a second",
        "a simulated second",
        "follows",
    )
    yield markdown_table(head, rows)
