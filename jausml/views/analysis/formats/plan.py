"""Plans of a partition as text, and as plain values for JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from jausml.language.metamodel.classes.system import System
from jausml.language.semantics.paths.scopes import Carrier
from jausml.views.analysis.formats.text import cut, kilobytes, number, table, wrapped
from jausml.views.analysis.partition.plans import Plan, Planned, Planner
from jausml.views.analysis.sizes import Assumptions

_HEAD = ("", "host", "connections", "CPU %", "datagrams/s", "kB/s to hosts", "wait ms")
_WIDTH = 30
_LEFT = 2


def render(plan: Plan) -> str:
    """Returns the bridges before and after, and why."""
    return "\n".join(_lines(plan)) + "\n"


def plain(plan: Plan) -> dict[str, Any]:
    """Returns a plan as JSON has it."""
    return {
        "before": [_plain(planned) for planned in plan.before],
        "after": [_plain(planned) for planned in plan.after],
        "moved": {named(carrier): planned.name for carrier, planned in plan.moved},
        "faults": list(plan.faults),
        "excess": list(plan.excess),
    }


def changes_of(system: System, assumptions: Assumptions) -> tuple[str, ...]:
    """Returns the changes of the cost if bridges were one, or one were two."""
    return tuple(_change(old, new) for old, new in Planner(system, assumptions).changes())


def _change(old: Sequence[Planned], new: Sequence[Planned]) -> str:
    names = [" and ".join(planned.name for planned in some) for some in (old, new)]
    title = f"{names[0]} as one" if len(old) > len(new) else f"{names[0]} as {len(new)}"
    datagrams, remote = (
        sum(getattr(planned, figure) for planned in new)
        - sum(getattr(planned, figure) for planned in old)
        for figure in ("datagrams", "remote")
    )
    wait = max(planned.wait for planned in new)
    load = ", ".join(f"{number(planned.share * 100)} %" for planned in new)
    return (
        f"{title}: {load} of a processor; {datagrams:+.0f} datagrams/s; {remote / 1e3:+.0f} kB/s "
        f"between hosts; a message waits {wait * 1e3:.2f} ms at most behind one of each connection"
    )


def _lines(plan: Plan) -> Iterator[str]:
    rows: list[tuple[str, ...]] = [("before", *[""] * (len(_HEAD) - 1))]
    rows += map(_row, plan.before)
    if plan.is_change:
        rows += [("after", *[""] * (len(_HEAD) - 1)), *map(_row, plan.after)]
    yield from (line.rstrip() for line in table(_HEAD, rows, _LEFT))
    if not plan.is_change:
        yield "nothing that holds the limits would cost less"
    for planned in plan.after:
        arrived = [named(carrier) for carrier, new in plan.moved if new is planned]
        if arrived:
            yield from wrapped(f"{planned.name} gets {', '.join(arrived)}", "")
        for reason in planned.reasons:
            yield from wrapped(reason, "    ")
    for owner in plan.gone:
        yield f"{owner.name} carries nothing any more"
    for fault in (*plan.faults, *plan.excess):
        yield from wrapped(f"not held: {fault}", "")


def _row(planned: Planned) -> tuple[str, ...]:
    return (
        f"  {cut(planned.name, _WIDTH)}",
        str(planned.host.name) if planned.host is not None else "-",
        str(len(planned.carriers)),
        number(planned.share * 100),
        number(planned.datagrams),
        kilobytes(planned.remote),
        number(planned.wait * 1000),
    )


def _plain(planned: Planned) -> dict[str, Any]:
    return {
        "name": planned.name,
        "new": planned.owner is None,
        "host": str(planned.host.name) if planned.host is not None else "",
        "connections": [named(carrier) for carrier in planned.carriers],
        "processor_share": round(planned.share, 6),
        "datagrams_per_s": round(planned.datagrams, 3),
        "bytes_between_hosts_per_s": round(planned.remote, 1),
        "wait_s": round(planned.wait, 7),
        "reasons": list(planned.reasons),
    }


def named(carrier: Carrier) -> str:
    """Returns the name of a connection behind that of its bridge."""
    owner = carrier.eContainer()
    return f"{owner.name if owner is not None else ''}.{carrier.name}"
