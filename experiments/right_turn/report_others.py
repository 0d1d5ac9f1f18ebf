"""The parts of the page beside the turn itself: closeness, sweeps, polls, faults, simulators."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from experiments.right_turn.tables import figure, markdown_table, number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


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
    yield figure("polling", figures, "Path, steering and delay of bridges that poll", data)


def _faults(data: Mapping[str, Any]) -> Iterator[str]:
    found = {name: data["summaries"].get(name) for name in ("stress", "stress_virtual")}
    if any(found.values()):
        yield "## When something fails\n"


def _waypoints(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("waypoints")
    if not found:
        return
    yield "## A robot along waypoints\n"
    yield figure("waypoints", figures, "Path along waypoints, and the active element", data)


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
