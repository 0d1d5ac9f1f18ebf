"""The page on the experiment, and the table on the terminal: both made of the data alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from catvehicle.metrics import Table

from experiments.right_turn.comparisons import HOP_NAMES
from experiments.right_turn.results import MEASURES, QUIET_SHARE
from experiments.right_turn.tables import answer, figure, markdown_table, number

_INTRODUCTION = """\
# The right turn, by JAUS alone and through the bridge

Does a car drive the same turn through a generated bridge as without one? `make experiment` drives,
judges and writes this page in five minutes. The figures are from CPython {python}
on {processors} processors.

The paper that proposed bridges made from models (Morley, Warren, Rabb, Whitsitt, Bunting and
Sprinkle, *Generating a ROS/JAUS Bridge for an Autonomous Ground Vehicle*, 2013) compared two
drives by eye (its Fig. 6), and saw the second one steer "more wildly". Here both are repeated and
measured: **J** has vehicle, operator and controllers as JAUS components; in **R**, the controllers
are ROS 2 nodes behind one generated bridge. They share the code of vehicle and control laws, and
are processes with sockets and rclpy.
"""

_NOT_REPRODUCED = """\
## What could not be reproduced

The logs of the original drives and the car's JAUS code are not public. The size of the path, the
safe curve and the speed law are ours; the steering law and the vehicle are made of public data on
the CAT Vehicle. `catvehicle/parameters.py` of the example has each number with its source. So the
shape of the drives and the claims are reproduced, and not single data points.
"""


def page(data: Mapping[str, Any], figures: str = "figures") -> str:
    """Returns the page.

    Args:
        data: Results as `gather` returns them.
        figures: Folder of the figures, as seen from the page.
    """
    parts = [
        _INTRODUCTION.format(**data["machine"]),
        *_incomplete(data),
        *_claims(data),
        *_drives(data, figures),
        *_verdicts(data),
        *_latency(data, figures),
        *_steering(data, figures),
        *_simulator(data, figures),
        _NOT_REPRODUCED,
    ]
    return "\n".join(parts)


def table_of_drives(data: Mapping[str, Any]) -> list[list[str]]:
    """Returns rows of measures, the systems as columns, with their heading."""
    systems = data["systems"]
    rows = [["mean (least to most)", *systems]]
    counts = (
        f"{system_data['arrived']} of {system_data['drives']}" for system_data in systems.values()
    )
    rows.append(["arrived", *counts])
    for measure in MEASURES:
        cells = (
            _cell(system_data["measures"].get(measure.name)) for system_data in systems.values()
        )
        rows.append([f"{measure.words}, {measure.unit}", *cells])
    return rows


def table(data: Mapping[str, Any]) -> str:
    """Returns the tables for the terminal: drives, verdicts and claims."""
    head, *rows = table_of_drives(data)
    drives = Table(*head)
    for row in rows:
        drives.add(*row)
    texts = [drives.render()]
    for verdict in data["verdicts"]:
        shown = Table(verdict["title"], "value", "interval", "bound", "")
        for row in verdict["rows"]:
            value, bound = number(row["value"]), number(row["bound"])
            shown.add(row["name"], value, _interval(row), bound, _kept(row))
        texts.append(shown.render())
    claims = Table("claim", "holds")
    for claim in data["claims"]:
        claims.add(claim["text"], answer(claim).strip("*"))
    return "\n\n".join([*texts, claims.render()])


# ------------------------------------------------------------------ parts of the page


def _incomplete(data: Mapping[str, Any]) -> Iterator[str]:
    quiet = QUIET_SHARE * data["machine"]["processors"]
    if data["load"] is not None and data["load"] > quiet:
        yield (
            f"**Other work was done meanwhile**: the load of the computer was {data['load']:g} "
            "before the drives in real time. It disturbed both J and R, and the delays are too "
            "long. Measure the results in real time again on a quiet computer.\n"
        )
    if data["quick"]:
        yield "**This was a quick look**: it has few drives.\n"
    if data["failed"]:
        yield "**Some stages failed**, so their parts are missing or out of date:\n"
        yield "\n".join(f"- {name}: {why}" for name, why in sorted(data["failed"].items())) + "\n"


def _claims(data: Mapping[str, Any]) -> Iterator[str]:
    yield "## In short\n"
    yield markdown_table(
        ("claim", "holds"), [(claim["text"], answer(claim)) for claim in data["claims"]]
    )
    yield (
        "`make experiment` fails when one of these claims does not hold. Some of them require that "
        "something is *refused*, because an experiment that cannot fail proves nothing.\n"
    )


def _drives(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    yield "## The turn\n"
    yield figure("turn", figures, "Paths and speeds over tyre angles of both systems", data)
    yield (
        "On the left, the prescribed path and the driven one. On the right, the speed over the "
        "tyre angle, with the boundary of the safe region and the limiter of the speed controller. "
        "The coloured line is the first drive. Thin grey lines show the others; where none is to "
        "be seen, they lie below it. Both rows have the same axes.\n"
    )
    head, *rows = table_of_drives(data)
    yield markdown_table(head, rows)
    yield figure("gaps", figures, "Differences of drives over time", data)
    yield (
        "How far two drives are apart at equal times since the first motion. R is compared with J, "
        "and J with another J, which shows how well the experiment itself can be repeated. The "
        "lines are medians of all pairs; the shaded areas contain all of them.\n"
    )


def _verdicts(data: Mapping[str, Any]) -> Iterator[str]:
    if not data["verdicts"]:
        return
    yield "## Are the two systems equivalent?\n"
    yield (
        "Finding no difference would prove little, because with too few drives no difference can "
        "be found. The test is therefore one of *equivalence*: the whole confidence interval of a "
        "difference must lie within a bound. All bounds follow from one tolerated delay and its "
        "effects in the plant, the control laws and the codec "
        "(`experiments/right_turn/judging.py` derives them). An *excess* is how much farther apart "
        "R and J are than two drives of J.\n"
    )
    for verdict in data["verdicts"]:
        yield f"### {verdict['title']}\n"
        expected = "" if verdict["must_pass"] else "This comparison must fail. "
        yield f"{verdict['about']} {expected}{verdict['pairs']} pairs: {_outcome(verdict)}.\n"
        rows = [
            (
                row["name"],
                number(row["value"]),
                _interval(row),
                number(row["bound"]),
                "**broken**" if row["differs"] else _kept(row),
            )
            for row in verdict["rows"]
        ]
        yield markdown_table(("measure", "value", "interval", "bound", ""), rows)
    yield from _controls(data)
    yield from _closeness(data)


def _kept(row: Mapping[str, Any]) -> str:
    if row["passes"]:
        return "kept"
    return "broken" if row["differs"] else "open"


def _outcome(verdict: Mapping[str, Any]) -> str:
    if verdict["passes"]:
        return "shown to be equivalent"
    return (
        "shown to be different"
        if verdict["differs"]
        else "shown to be neither equivalent nor different"
    )


def _interval(row: Mapping[str, Any]) -> str:
    low, high = row["interval"] or (None, None)
    return "" if low is None else f"{number(low)} to {number(high)}"


def _cell(spread: Mapping[str, float] | None) -> str:
    if spread is None:
        return ""
    mean, least, most = (number(spread[name]) for name in ("mean", "least", "most"))
    return mean if least == most else f"{mean} ({least} to {most})"


def _latency(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    yield "## Delay\n"
    yield figure("latency", figures, "Distribution of the delay on each way", data)
    yield (
        "The delays of all drives in real time. The triangle marks the 99th percentile. *Report to "
        "its answer* is the whole loop, including the controller.\n"
    )
    rows = []
    for system, system_data in data["systems"].items():
        for hop, words in HOP_NAMES.items():
            times = system_data["latency"].get(hop)
            if times:
                marks = (number(1000 * times[name]) for name in ("p50", "p95", "p99", "max"))
                rows.append((system, words, f"{times['count']:,}", *marks))
    head = ("", "way", "messages", "median, ms", "95 %, ms", "99 %, ms", "longest, ms")
    yield markdown_table(head, rows)


def _steering(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    yield "## Steering\n"
    yield figure("steering", figures, "Tyre angle, steering activity, and that of each drive", data)
    yield (
        "The paper called the steering *wild*. Here it is measured as the sum of all changes of "
        "the tyre angle during a drive.\n"
    )


def _controls(data: Mapping[str, Any]) -> Iterator[str]:
    """Yields the systems that the test must distinguish from J."""
    controls = data["summaries"].get("wall", {}).get("controls")
    if not controls:
        return
    yield "### What the test must distinguish from J\n"
    rows = [
        (
            control["about"],
            control["drives"],
            answer({"holds": control["differs"]}),
            "; ".join(control["by"]),
        )
        for control in controls.values()
    ]
    yield markdown_table(("drives in real time", "", "shown to be different", "by"), rows)


def _closeness(data: Mapping[str, Any]) -> Iterator[str]:
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


def _simulator(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    summary = data["summaries"].get("simulator")
    if not summary:
        return
    yield "## With a simulator\n"
    yield (
        "The plant is a separate process with ROS topics and its own time, as in Gazebo. A JAUS "
        f"unit behind the bridge asks for {summary['rate']:g} reports a second. The reports follow "
        "the time of the simulation:\n"
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
        for name, run in summary["runs"].items()
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
