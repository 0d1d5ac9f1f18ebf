"""The parts of the page beside the turn itself: closeness, sweeps, polls, faults, simulators."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from experiments.right_turn.tables import answer, figure, markdown_table, number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


def controls(data: Mapping[str, Any]) -> Iterator[str]:
    """Yields the systems that the test must distinguish from J."""
    found = data["summaries"].get("wall", {}).get("controls")
    if not found:
        return
    yield "### What the test must distinguish from J\n"
    rows = [
        (
            each["about"],
            each["drives"],
            answer({"holds": each["differs"]}),
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
        'The paper calls the two drives "sufficiently bi-similar". Here a pair of numbers '
        "expresses this. Two drives are bi-similar up to (τ, ε) if for each state of either drive, "
        "the other one has a state within τ seconds and a distance of ε. The table shows the "
        "smallest ε of all pairs of J and R in real time:\n"
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
    ("nominal", "null"): "without faults; J with another seed shows the natural variation",
    ("control",): "systems that must be refused",
    ("way", "J"): "a delay in one direction, and J with the delay in both",
    ("fault",): "jitter, reordering, duplicates, bursts of losses",
    ("rate",): "other rates of the reports",
}
"""Groups of cells of the sweep that have a table."""

_REMARKS = {
    ("fault",): (
        "When packets overtake each other, R tolerates less than J. R sends speed and tyre angle "
        "as two streams of SetWrenchEffort from one bridge to one vehicle. The vehicle ignores "
        "commands that are older than the last one of the same sender, so it drops the overtaken "
        "ones (`component.out_of_order`). J sends both values in one message. R could do the same "
        "with one ROS topic for both values, or with a join of the two topics.\n"
    ),
}
"""What is to be said below the table of a group."""


def _sweep(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("sweep")
    if not found:
        return
    yield "## How much delay and loss it tolerates\n"
    yield (
        "In virtual time, the links between vehicle and bridge have a set delay and loss. Each "
        "cell is driven with several seeds, which set the phases between the processes, and "
        "compared with J without faults. The worst drive counts. A cell is accepted when "
        "every bound is kept.\n"
    )
    yield figure("map", figures, "Least safety margin over delay and loss", data)
    yield (
        "The number in a cell is the smallest margin to the boundary of the safe region, in m/s; a "
        "negative number means that the vehicle left the region, and the cell is the darker the "
        "farther it went. Where many packets are lost, the car drives so slowly that it keeps away "
        "from the boundary: the cross shows that other bounds are broken. The delay is added in "
        "each direction, so it occurs twice in the loop.\n"
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
        yield "The limits, found by bisection:\n"
        rows = [
            (each["way"], each["criterion"], each["holds"], each["breaks"], each["unit"])
            for each in found["limits"]
        ]
        yield markdown_table(
            ("delay or loss", "criterion", "still met at", "no longer met at", ""), rows
        )


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
        "The paper describes a bridge that runs at a frequency which is given at the start. This "
        "section rebuilds it as far as the text describes it. It has the same models and "
        "translations, but a message that arrives on either side waits for the next poll, and only "
        "the newest one is carried. It is compared in virtual time with the generated bridge, "
        "which passes messages at once.\n\n"
        "The vehicle stops when it gets no command for 0.2 s, so it hardly moves behind a bridge "
        "that polls slowly. To show the effect of the delay alone, these bridges are also driven "
        "with a longer time before the stop (*patience*).\n"
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
    yield "## A robot that drives along waypoints\n"
    yield (
        "This experiment uses another robot and other services. An operator unit gives a list of "
        "waypoints to a robot with differential drive. In R, its controller is a ROS node behind "
        "ready maps, which serves the action of Nav2. In J, the robot is a JAUS component with the "
        "same body and the same law, and there is no ROS. The robot must pass each waypoint within "
        f"{number(found['tolerance_m'])} m.\n"
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
    head = (
        "drive",
        "waypoints",
        "duration, s",
        "stopped after, s",
        "moved after the stop, m",
        "as required",
    )
    yield markdown_table(head, rows)
    yield from _virtual_waypoints(found)


def _virtual_waypoints(found: Mapping[str, Any]) -> Iterator[str]:
    virtual = found["virtual"]
    yield (
        "In virtual time, J and R drive the whole list with several seeds, meet an emergency, and "
        "lose their operator. Their paths may be apart by what one more period of the odometry "
        "(20 ms) does to the same body and law without any middleware "
        "(`experiments/waypoints/equivalence.py`), and in real time by what three more do. Times "
        "do not count:\n"
    )
    rows = [
        (name, f"{gap:.4f}", f"{virtual['bound']:.4f}") for name, gap in virtual["gaps"].items()
    ]
    rows.append(("R from J, real time", f"{found['gap']:.4f}", f"{found['bound']:.4f}"))
    yield markdown_table(("farthest point of a path from the other, m", "", "bound"), rows)
    yield "R with one mistake each must be refused:\n"
    rows = [
        (each["about"], each["drive"], "; ".join(each["by"]) or "**nothing**")
        for each in virtual["controls"].values()
    ]
    yield markdown_table(("mistake", "drive", "what does not hold"), rows)


def _simulator(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    found = data["summaries"].get("simulator")
    if not found:
        return
    yield "## With a simulator\n"
    yield (
        "The plant is a separate process with ROS topics and its own time, as in Gazebo "
        "([Connect a simulator to a bridge](how-to/simulators.md)). A JAUS unit behind the bridge "
        f"asks for {found['rate']:g} reports a second. The reports follow the time of the "
        "simulation:\n"
    )
    yield figure("simulator", figures, "Rate of JAUS events over the pace of the simulation", data)
    rows = [
        (
            name.replace("_", " "),
            "simulated" if run["follows_clock"] else "real",
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
        "reports a simulated second",
        "follows",
    )
    yield markdown_table(head, rows)
