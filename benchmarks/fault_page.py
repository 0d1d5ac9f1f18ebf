"""The page on faults, made of what `make faults` found.

Usage: fault_page.py [--check]

With --check the exit code is 1 when something took longer than fault_bounds.json allows.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tables import table

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

HERE = Path(__file__).resolve().parent
DATA, BOUNDS = HERE / "faults.json", HERE / "fault_bounds.json"
PAGE = HERE.parent / "docs" / "reference" / "faults.md"
CONNECTIONS = {
    "drive": "command, ROS to JAUS, under control; silence of 0.4 s, control lapses after 2 s",
    "cruise": "command, JAUS to ROS, under control; silence of 0.5 s",
    "odometry": "event, JAUS to ROS; silence of 0.5 s",
    "pose": "query, JAUS to ROS",
    "estimate": "event at each change, ROS to JAUS",
}
_INTRODUCTION = """\
# What happens when something fails

Made by `make faults` from `benchmarks/faults.json`; do not edit. Measured with CPython {python}
on {processors} processors with other work beside, whose load was {load:g} in the last
run; each line is of one run, so that times are examples and no promises.

One generated bridge (`tests/cases/bridge_loop`) stands between a JAUS vehicle, a JAUS operator and
a ROS node, each a process of its own. Twenty messages a second flow by each connection, and each
value says when it was sent. Then something fails, for some seconds, and is over. Nobody touches
the bridge.

JAUS goes over UDP, and in faults whose names say so over TCP, or through a node manager (a stand-in
that speaks the local protocol of Junior's). A TCP connection that is held is one whose cable is
pulled out: nothing passes, and all that was sent passes afterwards.

Of each fault `tests/faults` demands:

- afterwards what is sent then arrives by every connection;
- while it lasts, the stop stands on the other side of what is lost;
- no command older than {stale:g} s is obeyed, not even of those that waited somewhere;
- nothing that was not foreseen is in any log, and all programs end with 0 when they are asked to.

"stop" is the time from the fault to the stop on the other side, "back" that from its end, or from
the start of the new process, to the first message that was sent after it. Where a process starts
anew, that contains the start of Python, and the time in which DDS finds topics.
"""


def page(data: Mapping[str, Any]) -> str:
    """Returns the page.

    Args:
        data: What was found: `machine`, `stale` in seconds, and `faults` by name.
    """
    head = ("fault", *(f"{each}, back" for each in CONNECTIONS), "stop", "oldest command")
    rows = [
        (
            name,
            *(found["recovered"].get(each) for each in CONNECTIONS),
            ", ".join(f"{each} {time:g}" for each, time in sorted(found["stopped"].items())),
            max(found["oldest"].values()),
        )
        for name, found in sorted(data["faults"].items())
    ]
    parts = [
        _INTRODUCTION.format(**data["machine"], stale=data["stale"]),
        "## The connections\n",
        table(("connection", "kind"), CONNECTIONS.items()),
        "## Faults\n",
        "Seconds.\n",
        table(head, rows),
        *_floods(data.get("floods", {})),
    ]
    return "\n".join(parts)


def _floods(floods: Mapping[str, Any]) -> Iterator[str]:
    if not floods:
        return
    yield "## Floods\n"
    yield (
        "One process sends as many datagrams as it can, at most 50,000 a second, to the port of "
        "the bridge. The share that arrives is that of the connection that suffers most, against "
        "the same time without a flood; the times are the ages of all that arrived. Each "
        "line is of that of three runs in which most arrived: the processors have other work, that "
        "of the sender of the flood at least. The bridge with `allowedHosts` needs a quarter of a "
        "processor for 50,000 datagrams a second that it refuses; where it seems to lose more than "
        "without, it did not get that.\n"
    )
    rows = [
        (
            name,
            each["sent"],
            each["processor"],
            each["rate"],
            each["alone"]["p99"],
            each["flooded"]["p99"],
        )
        for name, each in sorted(floods.items())
    ]
    head = (
        *("what", "datagrams a second", "processors for the bridge"),
        *("share that arrives", "99 % alone, s", "99 % flooded, s"),
    )
    yield table(head, rows)
    yield from _wild(floods)
    yield (
        "A bridge takes what comes to its one socket in turn, and the kernel drops what there is "
        "no room for, of whomever: a network that may be flooded needs a filter before the "
        "bridge. `reports` come in the name of the vehicle, from elsewhere. With AS5669A they take "
        "its traffic over, unless the bridge says `fixedSources` or `allowedHosts` "
        "([how to secure](../how-to/secure.md)); what is refused by these costs less than what is "
        "taken.\n"
    )


def _wild(floods: Mapping[str, Any]) -> Iterator[str]:
    passed = {name: each["passed"] for name, each in floods.items() if "passed" in each}
    if passed:
        told = ", ".join(f"{each} a second with `{name}`" for name, each in sorted(passed.items()))
        yield (
            "`commands of the operator` are what it may say, 200 times as often as usual; the "
            f"share is that of all others. Of its own arrived {told}: without a cap a ROS node "
            "takes what it can, and its queue drops the rest.\n"
        )


def exceeded(data: Mapping[str, Any], bounds: Mapping[str, Any]) -> list[str]:
    """Returns what took longer than it may, a sentence each.

    Args:
        data: What was found.
        bounds: Seconds for `stopped` and `recovered`, by fault; "" stands for all others.
    """
    told = []
    for fault, found in sorted(data["faults"].items()):
        for what in ("stopped", "recovered"):
            limit = bounds[what].get(fault, bounds[what][""])
            told += [
                f"{fault}: {each} {what} after {seconds:g} s, the bound is {limit:g} s"
                for each, seconds in sorted(found[what].items())
                if seconds > limit
            ]
    return told


def main() -> int:
    """Writes the page; returns the exit code."""
    data = json.loads(DATA.read_text(encoding="utf-8"))
    PAGE.write_text(page(data), encoding="utf-8")
    told = exceeded(data, json.loads(BOUNDS.read_text(encoding="utf-8")))
    print("\n".join([*told, f"wrote {PAGE}"]))
    return 1 if told and "--check" in sys.argv[1:] else 0


if __name__ == "__main__":
    sys.exit(main())
