"""The page on the experiment, and the table on the terminal: both made of the data alone."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from catvehicle.metrics import Table

from experiments.right_turn import ROOT, report_others
from experiments.right_turn.comparisons import HOP_NAMES
from experiments.right_turn.results import MEASURES, QUIET_SHARE
from experiments.right_turn.tables import answer, figure, markdown_table, number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

DATA = ROOT / "experiments" / "results.json"
PAGE = ROOT / "docs" / "experiment.md"

_INTRODUCTION = """\
# The right turn, by JAUS alone and through the bridge

This page shows whether a car drives the same turn through a generated bridge as without one, and
how much delay and loss it tolerates. `make experiment` writes the page from
`experiments/results.json`; do not edit it. The figures are from CPython {python} on {processors}
processors.

The paper that proposed bridges made from models (Morley, Warren, Rabb, Whitsitt, Bunting and
Sprinkle, *Generating a ROS/JAUS Bridge for an Autonomous Ground Vehicle*, 2013) let a car drive a
right-hand turn twice: with JAUS components alone, and with ROS controllers behind a bridge. The
authors compared the two drives by eye. They saw the second one steer "more wildly", and suspected
the delay of their bridge. Here the turn is repeated with two systems, and measured:

- **J**: vehicle, operator and controllers are JAUS components.
- **R**: vehicle and operator are the same; the controllers are ROS 2 nodes, and all messages
  between them and the vehicle pass through one generated bridge.

Both systems use the same code for vehicle and controllers. In *real time*, `jausml generate` wrote
the systems, and they run as processes with sockets and rclpy on one computer. In *virtual time*,
the same generated code runs on one simulated clock, with a network whose delays and losses can be
set ([Test in virtual time](how-to/virtual-time.md)). There, equal seeds give equal drives, to the
last bit.
"""

_NOT_REPRODUCED = """\
## What could not be reproduced

- **The vehicle and its data.** The logs of the original drives are not public, nor is the car's
  JAUS code. Vehicle and actuators are simulated from public data on the CAT Vehicle.
- **The safe curve.** The paper draws a line between safe and unsafe pairs of speed and tyre angle,
  but gives no numbers. Here the line is a limit of the lateral acceleration, which is the usual
  meaning of such a curve. Its value is an assumption.
- **The prescribed path.** The paper describes its shape, but not its size. We chose the lengths of
  the straights and the radius of the arc so that the limiter must act.
- **The controllers.** The paper says what they do, but not how. The steering law is the public one
  from the simulator of the same vehicle, at the front axle. The speed law is ours.
- **The positioning of the car.** In the paper's figure, the measured path jumps where the receiver
  found its position. This comes from equipment that is not simulated.
- **The cause of the wilder steering.** We can show what a delay does, and that a polling bridge has
  such a delay. Whether it was the cause in the original car cannot be told from outside.

In short, the shape of the drives and the claims are reproduced, but not single data points.
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
    quiet = QUIET_SHARE * data["machine"]["processors"]
    if data["load"] is not None and data["load"] > quiet:
        yield (
            f"**Other work was done meanwhile**: the load of the computer was {data['load']:g} "
            "before the drives in real time. It disturbed both J and R, and the delays are too "
            "long. Measure the results in real time again on a quiet computer.\n"
        )
    if data["quick"]:
        yield "**This was a quick look**: it has few drives, and few cases of the sweep.\n"
    if data["failed"]:
        yield "**Some stages failed**, so their parts are missing or out of date:\n"
        yield "\n".join(f"- {name}: {why}" for name, why in sorted(data["failed"].items())) + "\n"


def _claims(data: Mapping[str, Any]) -> Iterator[str]:
    yield "## In short\n"
    yield markdown_table(
        ("claim", "holds"),
        [(claim["text"], answer(claim)) for claim in data["claims"]],
    )
    yield (
        "`make experiment` fails when one of these claims does not hold. Some of them require that "
        "something is *refused*, because an experiment that cannot fail proves nothing.\n"
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
        "All figures are means. P5 is a bridge that polls five times a second, and so on. The "
        "systems with an additional delay of 100 ms in each direction, and those with a car that "
        "understeers without the controllers knowing, are included because they must be refused.\n"
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
    yield from report_others.controls(data)
    yield from report_others.closeness(data)


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
        "The paper called the steering *wild*. Here it is measured as the sum of all changes of "
        "the tyre angle during a drive.\n"
    )


def _parameters(data: Mapping[str, Any]) -> Iterator[str]:
    yield "## Parameters\n"
    yield (
        "`catvehicle/parameters.py` of the example defines each parameter with its source. "
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
