"""The parts of the page beside the turn itself: closeness, sweeps, polls, faults, simulators."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from experiments.right_turn.tables import figure, markdown_table, number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


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
    yield from _simulator(data, figures)


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
