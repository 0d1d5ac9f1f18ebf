"""The page on the experiment, and the table on the terminal: both made of the data alone."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from catvehicle.metrics import Table

from experiments.right_turn import ROOT, report_others
from experiments.right_turn.comparisons import HOP_NAMES
from experiments.right_turn.results import MEASURES
from experiments.right_turn.tables import answer, figure, markdown_table, number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

DATA = ROOT / "experiments" / "results.json"
PAGE = ROOT / "docs" / "experiment.md"

_QUIET_SHARE = 0.5
"""Processes that want a processor, for each there is, up to which a computer is quiet."""

_INTRODUCTION = """\
# The right turn, by JAUS alone and through the bridge

Made by `make experiment` from `experiments/results.json`; do not edit. Measured with CPython
{python} on {processors} processors.

The paper that proposed bridges made from models (Morley, Warren, Rabb, Whitsitt, Bunting and
Sprinkle, *Generating a ROS/JAUS Bridge for an Autonomous Ground Vehicle*, 2013) let a car drive a
right-hand turn twice: by JAUS components alone, and by ROS controllers behind a bridge. It judged
the two by looking at them, saw the second one steer "more wildly", and suspected the delay of its
bridge. Here the turn is driven again, with numbers:

- **J**: vehicle, operator and controllers are JAUS components.
- **R**: the same vehicle and operator; the controllers are ROS 2 nodes, and everything between them
  and the vehicle passes one generated bridge.

Vehicle and controllers are the same code in both. Where it says *real time*, the systems are what
`jausml generate` writes, as processes with sockets and rclpy, on one computer. In *virtual time*
the same generated code runs on one simulated clock and a network that delays and loses what it is
told to ([how](how-to/virtual-time.md)); equal seeds give equal drives there, to the last bit.
"""

_NOT_REPRODUCED = """\
## What could not be reproduced

- **The vehicle and its data.** The logs of the original drives are not public, nor is the car's
  JAUS code. Vehicle and actuators are simulated, from what is public of the CAT Vehicle.
- **The safe curve.** The paper draws a line between safe and unsafe pairs of speed and tyre angle
  and gives no numbers. Here it is a bound on the lateral acceleration, as such a limit is usually
  meant; its value is an assumption.
- **The prescribed path.** Its shape is told, not its numbers. Straight, arc and straight have
  lengths of our own, so that the limiter must act.
- **The controllers.** The paper says what they do and not how. The steering law is the public one
  of the same vehicle's simulator, at the front axle; the speed law is ours.
- **The positioning of the car.** The jump of the measured path in the paper's figure, where the
  receiver found its position, comes of equipment that is not simulated.
- **The cause of the wilder steering.** We can show what a delay does, and that a bridge that polls
  has it. Whether that was the cause in the original car nobody can tell from outside.

So shape and claims are reproduced, not points.
"""


def page(data: Mapping[str, Any], figures: str = "experiment") -> str:
    """Returns the page.

    Args:
        data: Results as `gather` returns them.
        figures: Folder of the figures, as seen from the page.
    """
    parts = [
        _INTRODUCTION.format(**data["machine"]),
        *_incomplete(data),
        *_claims(data),
        *_all_systems(data),
        *_drives(data, figures),
        *_verdicts(data),
        *_latency(data, figures),
        *_steering(data, figures),
        *report_others.parts(data, figures),
        _NOT_REPRODUCED,
        *_parameters(data),
    ]
    return "\n".join(parts)


def table_of_drives(data: Mapping[str, Any]) -> list[list[str]]:
    """Returns rows of measures, the systems as columns, with their heading."""
    systems = data["systems"]
    rows = [["mean (least to most)", *systems]]
    counts = (f"{found['arrived']} of {found['drives']}" for found in systems.values())
    rows.append(["arrived", *counts])
    rows.append(["time", *(found["clock"] for found in systems.values())])
    for each in MEASURES:
        cells = (_cell(found["measures"].get(each.name)) for found in systems.values())
        rows.append([f"{each.words}, {each.unit}", *cells])
    return rows


def table(data: Mapping[str, Any]) -> str:
    """Returns the tables for the terminal: drives, verdicts and claims."""
    head, *rows = table_of_drives(data)
    drives = Table(*head)
    for row in rows:
        drives.add(*row)
    others = Table("system", *(f"{each.words}, {each.unit}" for each in MEASURES))
    for name, found in data["baselines"].items():
        spreads = (found["measures"].get(each.name, {}) for each in MEASURES)
        others.add(name, *(number(spread.get("mean")) for spread in spreads))
    texts = [drives.render(), others.render()]
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
    quiet = _QUIET_SHARE * data["machine"]["processors"]
    if data["load"] is not None and data["load"] > quiet:
        yield (
            f"**Other work was done meanwhile**: the load of the computer was {data['load']:g} "
            "before the drives in real time. They are disturbed, J as well as R, and delays are "
            "too long; what is said of real time has to be measured again where it is quiet.\n"
        )
    if data["quick"]:
        yield "**This was a quick look**: few drives, and few cases of the sweep.\n"
    if data["failed"]:
        yield "**Stages that failed**, so that their part is missing or old:\n"
        yield "\n".join(f"- {name}: {why}" for name, why in sorted(data["failed"].items())) + "\n"


def _claims(data: Mapping[str, Any]) -> Iterator[str]:
    yield "## In short\n"
    yield markdown_table(
        ("claim", "holds"),
        [(claim["text"], answer(claim)) for claim in data["claims"]],
    )
    yield (
        "`make experiment` fails when one of these does not hold. A claim that something must "
        "*fail* is there because an experiment that cannot fail proves nothing.\n"
    )


def _all_systems(data: Mapping[str, Any]) -> Iterator[str]:
    yield "## All systems in numbers\n"
    head = ("system", "clock", "arrived", *(f"{each.words}, {each.unit}" for each in MEASURES))
    rows = []
    for name, found in {**data["systems"], **data["baselines"]}.items():
        arrived = "" if found["arrived"] is None else f"{found['arrived']} of {found['drives']}"
        cells = (found["measures"].get(each.name, {}).get("mean") for each in MEASURES)
        rows.append((name, found["clock"], arrived, *map(number, cells)))
    yield markdown_table(head, rows)
    yield (
        "Means. P5 is a bridge that polls five times a second, and so on. What has 100 ms more on "
        "each way, and the car that understeers, which the controllers do not know, are there to "
        "be refused.\n"
    )


def _drives(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    yield "## The turn\n"
    yield figure("turn", figures, "Paths and speeds over tyre angles of both systems", data)
    yield (
        "Left the prescribed path and the driven one; right speed over tyre angle with the "
        "boundary of the safe region and the limiter of the speed controller. Thin grey lines are "
        "all drives, the coloured one is the first. Both rows have the same axes.\n"
    )
    head, *rows = table_of_drives(data)
    yield markdown_table(head, rows)
    yield figure("gaps", figures, "Differences of drives over time", data)
    yield (
        "How far two drives are apart at equal times since the first motion: R from J, beside J "
        "from another J, which is what the experiment itself cannot repeat. Lines are medians of "
        "all pairs, the shade holds all of them.\n"
    )


def _verdicts(data: Mapping[str, Any]) -> Iterator[str]:
    if not data["verdicts"]:
        return
    yield "## Are they the same?\n"
    yield (
        "That no difference was found would prove little: too few drives never find one. So the "
        "test is one of *equivalence*: the whole confidence interval of a difference must lie "
        "within the bound. All bounds follow from one delay that is tolerated, and from what "
        "plant, laws and codec make of it (`experiments/right_turn/judging.py` derives them). An "
        "*excess* is how much farther apart R and J are than one J from another.\n"
    )
    for verdict in data["verdicts"]:
        yield f"### {verdict['title']}\n"
        expected = "" if verdict["must_pass"] else "This one must fail. "
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
    yield from report_others.controls(data)
    yield from report_others.closeness(data)


def _kept(row: Mapping[str, Any]) -> str:
    if row["passes"]:
        return "kept"
    return "broken" if row["differs"] else "open"


def _outcome(verdict: Mapping[str, Any]) -> str:
    if verdict["passes"]:
        return "shown to be equivalent"
    return "shown to be different" if verdict["differs"] else "neither the same nor different"


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
        "In real time, all drives together. The triangle marks the 99th percentile. *Report to "
        "its answer* is the whole way, controller included.\n"
    )
    rows = []
    for system, found in data["systems"].items():
        for hop, words in HOP_NAMES.items():
            times = found["latency"].get(hop)
            if times:
                marks = (number(1000 * times[name]) for name in ("p50", "p95", "p99", "max"))
                rows.append((system, words, f"{times['count']:,}", *marks))
    head = ("", "way", "messages", "median, ms", "95 %, ms", "99 %, ms", "longest, ms")
    yield markdown_table(head, rows)


def _steering(data: Mapping[str, Any], figures: str) -> Iterator[str]:
    yield "## Steering\n"
    yield figure("steering", figures, "Tyre angle, steering activity, and that of each drive", data)
    yield (
        "The paper's word was *wildly*. The measure of it is the sum of all changes of the tyre "
        "angle over a drive.\n"
    )


def _parameters(data: Mapping[str, Any]) -> Iterator[str]:
    yield "## Parameters\n"
    yield (
        "Each is defined, with its source, in `catvehicle/parameters.py` of the example. "
        "**Assumption** marks a number that nobody has published.\n"
    )
    rows = [
        (
            row["name"],
            number(row["value"]),
            "" if row["unit"] == "1" else row["unit"],
            row["source"].replace("assumption", "**assumption**"),
            row["meaning"],
        )
        for row in data["parameters"]
    ]
    yield markdown_table(("parameter", "value", "unit", "source", "meaning"), rows)


def main() -> None:
    """Writes the page from the data that is stored."""
    data = json.loads(DATA.read_text(encoding="utf-8"))
    PAGE.write_text(page(data), encoding="utf-8")


if __name__ == "__main__":
    main()
