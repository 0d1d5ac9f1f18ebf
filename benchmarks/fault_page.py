"""The page on faults, made of what `make faults` found.

Usage: fault_page.py DATA

Writes the page beside the data. The exit code is 1 when something took longer than
fault_bounds.json allows, or when it bounds a fault that was not provoked.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tables import table

BOUNDS = Path(__file__).resolve().parent / "fault_bounds.json"
CONNECTIONS = {
    "drive": "command, ROS to JAUS, under control; silence of 0.4 s, control lapses after 2 s",
    "cruise": "command, JAUS to ROS, under control; silence of 0.5 s",
    "odometry": "event, JAUS to ROS; silence of 0.5 s",
    "pose": "query, JAUS to ROS",
    "estimate": "event at each change, ROS to JAUS",
}
_INTRODUCTION = """\
# Faults and their effects

Look up how a bridge reacts when something fails, and how long it takes to recover. `make faults`
has written this page. The figures are from CPython {python} on {processors} processors; their load,
other work included, was {load:g} in the last run. Each line is from a single run, so the times are
examples and not guarantees.

One generated bridge (`tests/cases/bridge_loop`) stands between a JAUS vehicle, a JAUS operator and
a ROS node, each a process of its own. Every connection carries twenty messages a second. Then
something fails for some seconds, and recovers; nobody touches the bridge. `tests/faults` requires
that new messages arrive by every connection afterwards, that the stop is in effect on the other
side of the lost part meanwhile, and that no command older than {stale:g} s is obeyed.

"stop" is the time from the fault until the stop takes effect, "back" that from its end until the
first message arrives that was sent after it, with the start of Python and of DDS where a process is
started again.
"""


def page(data: Mapping[str, Any]) -> str:
    """Returns the page.

    Args:
        data: What was found: `machine`, `stale` in seconds, and `faults` by name.
    """
    head = (
        "fault",
        *(f"{connection}, back" for connection in CONNECTIONS),
        "stop",
        "oldest command",
    )
    rows = [
        (
            name,
            *(figures["recovered"].get(connection) for connection in CONNECTIONS),
            ", ".join(
                f"{connection} {time:g}" for connection, time in sorted(figures["stopped"].items())
            ),
            max(figures["oldest"].values()),
        )
        for name, figures in sorted(data["faults"].items())
    ]
    parts = [
        _INTRODUCTION.format(**data["machine"], stale=data["stale"]),
        "## The connections\n",
        table(("connection", "kind"), CONNECTIONS.items()),
        "## Faults\n",
        "All times are in seconds.\n",
        table(head, rows),
        *_guardian(data.get("guardian", {}), data.get("halts", {})),
        *_floods(data.get("floods", {})),
    ]
    return "\n".join(parts)


def _guardian(guardian: Mapping[str, Any], halts: Mapping[str, Any]) -> Iterator[str]:
    """What is stopped in place of a bridge that cannot, and what it obeys when it goes on."""
    if guardian:
        yield "## A bridge that cannot stop\n"
        yield "From the fault until the stop arrived; none: the bridge went on before.\n"
        rows = [
            (name, figures.get("drive"), figures.get("cruise"))
            for name, figures in guardian.items()
        ]
        yield table(("fault", "drive", "cruise"), map(_rounded, rows))
    if halts:
        yield "The oldest command that was obeyed after a halt of the bridge (SIGSTOP):\n"
        rows = [
            (name, figures.get("drive"), figures.get("cruise")) for name, figures in halts.items()
        ]
        yield table(("halted for", "drive", "cruise"), map(_rounded, rows))


def _rounded(row: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(round(cell, 2) if isinstance(cell, float) else cell for cell in row)


def _floods(floods: Mapping[str, Any]) -> Iterator[str]:
    if not floods:
        return
    yield "## Floods\n"
    yield (
        "One process sends as many datagrams as it can to the port of the bridge. The share is "
        "that of the connection that suffers most, against the same time without a flood; the "
        "best of three runs.\n"
    )
    rows = [
        (
            name,
            flood["sent"],
            flood["processor"],
            flood["rate"],
            flood["alone"]["p99"],
            flood["flooded"]["p99"],
        )
        for name, flood in sorted(floods.items())
    ]
    head = (
        *("what", "datagrams a second", "processors for the bridge"),
        *("share that arrives", "99 % alone, s", "99 % flooded, s"),
    )
    yield table(head, rows)


def exceeded(data: Mapping[str, Any], bounds: Mapping[str, Any]) -> list[str]:
    """Returns what took longer than it may and what was not provoked, a sentence each.

    Args:
        data: What was found.
        bounds: Seconds for `stopped` and `recovered`, by fault; "" stands for all others.
    """
    bounded = {fault for limits in bounds.values() for fault in limits if fault}
    sentences = [f"{fault}: not provoked" for fault in sorted(bounded - data["faults"].keys())]
    for fault, figures in sorted(data["faults"].items()):
        for what in ("stopped", "recovered"):
            limit = bounds[what].get(fault, bounds[what][""])
            sentences += [
                f"{fault}: {connection} {what} after {seconds:g} s, the bound is {limit:g} s"
                for connection, seconds in sorted(figures[what].items())
                if seconds > limit
            ]
    return sentences


def main(data_file: Path) -> int:
    """Writes the page; returns the exit code."""
    data = json.loads(data_file.read_text(encoding="utf-8"))
    written = data_file.with_suffix(".md")
    written.write_text(page(data), encoding="utf-8")
    sentences = exceeded(data, json.loads(BOUNDS.read_text(encoding="utf-8")))
    print("\n".join([*sentences, f"wrote {written}"]))
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
