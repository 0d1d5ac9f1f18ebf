"""Tables of connections and components: texts of cells, orders and filters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Any

from jausml.live.peers.rendering import printable
from jausml.live.systems.machines import MachineState
from jausml.live.systems.state import ComponentState, ConnectionState, SystemState

_BARS = "▁▂▃▄▅▆▇█"
LONGEST_CELL = 48  # characters

_MOST_SHARES = 4  # states of a machine, those with the most time, whose shares are in the table

# Titles of the tables of components and of state machines.
COMPONENT_TITLES = ("state", "component", "name", "management", "controlled by", "ms", "reason")
MACHINE_TITLES = ("component", "service", "machine", "state", "s in it", "entries", "share of time")


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the table of connections.

    Attributes:
        text: Returns the text of a connection.
        order: Returns the value by which connections are sorted; None is last in either order.
    """

    title: str
    text: Callable[[ConnectionState], str]
    order: Callable[[ConnectionState], Any]
    is_number: bool = False


def shown_name(connection: ConnectionState) -> str:
    """Returns the bridge and the name of a connection in one text."""
    return f"{connection.bridge.lstrip('/')} {connection.name}"


def state_text(connection: ConnectionState) -> str:
    """Returns the phase of a connection, or else its level."""
    return cell(connection.phase) or connection.level.value


def sparkline(history: Sequence[float], declared: float | None, width: int = 12) -> str:
    """Returns the last `width` rates as bars, the highest for the greatest or declared rate."""
    latest = history[-width:]
    top = max([*latest, declared or 0.0], default=0.0)
    if top <= 0:
        return _BARS[0] * len(latest)
    return "".join(_BARS[min(7, max(0, int(rate / top * 7.999)))] for rate in latest)


def cell(text: str, most: int = LONGEST_CELL) -> str:
    """Returns text without control characters, cut to `most` characters."""
    clean = printable(text[: most + 1])
    return clean if len(clean) <= most else clean[: most - 1] + "…"


def _figure(value: float | None, digits: int = 1) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _latency(connection: ConnectionState) -> str:
    parts = [connection.latency.get(f"in the bridge {percentile}") for percentile in ("p50", "p99")]
    return "" if None in parts else "/".join(f"{part / 1e3:.2f}" for part in parts if part)


def _drops(connection: ConnectionState) -> str:
    if not connection.drops:
        return "" if connection.told is None else "0"
    reason, count = max(connection.drops.items(), key=lambda item: item[1])
    more = "" if count == connection.dropped else "…"
    return f"{connection.dropped} {reason}{more}"


def _peers(connection: ConnectionState) -> str:
    return ", ".join(
        f"{key.removeprefix('peer ')} {value}" for key, value in connection.peers.items()
    )


# The columns of the table of connections.
COLUMNS = (
    Column("state", state_text, lambda connection: -connection.level.weight),
    Column("connection", shown_name, shown_name),
    Column(
        "Hz",
        lambda connection: _figure(connection.rate),
        lambda connection: connection.rate,
        is_number=True,
    ),
    Column(
        "declared",
        lambda connection: _figure(connection.declared_rate),
        lambda connection: connection.declared_rate,
        is_number=True,
    ),
    Column(
        "age s",
        lambda connection: _figure(connection.age),
        lambda connection: connection.age,
        is_number=True,
    ),
    Column(
        "p50/p99 ms",
        _latency,
        lambda connection: connection.latency.get("in the bridge p99"),
        is_number=True,
    ),
    Column(
        "lost",
        _drops,
        lambda connection: connection.dropped if connection.told is not None else None,
        is_number=True,
    ),
    Column("peers", _peers, lambda connection: _peers(connection) or None),
    Column(
        "reason", lambda connection: connection.reason, lambda connection: connection.reason or None
    ),
)


def is_descending(column: int, *, is_reversed: bool) -> bool:
    """Tells whether a column is sorted from above: numbers are, unless reversed."""
    return COLUMNS[column].is_number is not is_reversed


def arranged(
    state: SystemState, column: int, wanted: str = "", *, is_reversed: bool = False
) -> list[ConnectionState]:
    """Returns the connections whose names contain all words of a text, sorted by a column.

    Their ages are the present ones, which grow while their bridge is silent.
    """
    words = wanted.casefold().split()
    connections = sorted(
        (
            replace(connection, age=state.age_of(connection))
            for connection in state.connections.values()
            if all(word in shown_name(connection).casefold() for word in words)
        ),
        key=shown_name,
    )
    order = COLUMNS[column].order
    present = [connection for connection in connections if order(connection) is not None]
    absent = [connection for connection in connections if order(connection) is None]
    present.sort(key=order, reverse=is_descending(column, is_reversed=is_reversed))
    return present + absent


def row(connection: ConnectionState) -> list[str]:
    """Returns the cells of a connection, in the order of `COLUMNS`."""
    return [cell(column.text(connection)) for column in COLUMNS]


def by_address(state: SystemState) -> list[ComponentState]:
    """Returns the components in the order of their JAUS ids."""
    return sorted(
        state.components.values(),
        key=lambda component: [int(part) for part in component.address.split(".")],
    )


def component_row(component: ComponentState) -> list[str]:
    """Returns the cells of a component, in the order of `COMPONENT_TITLES`."""
    trip = component.round_trip
    return [
        component.level.value,
        component.address,
        cell(component.name),
        cell(component.state or "-"),
        cell(_control(component)),
        "" if trip is None else f"{trip * 1e3:.1f}",
        cell(component.reason),
    ]


def machine_rows(state: SystemState) -> list[list[str]]:
    """Returns the cells of the machines of all components, in the order of `MACHINE_TITLES`."""
    return [
        [component.address, *_machine(machine)]
        for component in by_address(state)
        for machine in component.present_machines
    ]


def _machine(machine: MachineState) -> list[str]:
    present = next((time for time in machine.times if time.state == machine.state), None)
    longest = machine.times[:_MOST_SHARES]
    names = _short_names([state_time.state for state_time in longest])
    return [
        cell(machine.service.rpartition(":")[2]),
        cell(machine.machine),
        cell(".".join(machine.state.split(".")[-2:])) or "-",
        _figure(machine.seconds),
        "" if present is None else str(present.entries),
        ", ".join(
            f"{cell(name)} {share_text(state_time.seconds, machine.total)}"
            for name, state_time in zip(names, longest, strict=True)
        ),
    ]


def _short_names(paths: Sequence[str]) -> list[str]:
    """Returns paths of states without the outer states that all of them share."""
    names = [path.split(".") for path in paths]
    columns = zip(*(name[:-1] for name in names), strict=False)
    around = len(list(takewhile(lambda column: len(set(column)) == 1, columns)))
    return [".".join(name[around:]) for name in names]


def share_text(seconds: float, total: float) -> str:
    """Returns a share of time in percent, `-` if there is no time."""
    return f"{seconds / total:.0%}" if total > 0 else "-"


def _control(component: ComponentState) -> str:
    if component.controller is None:
        return "-"
    if not component.controller:
        return "nobody"
    words = [f"authority {component.authority}"]
    if component.control_timeout is not None:
        seconds = component.control_timeout
        words.append(f"lapses after {seconds} s" if seconds else "never lapses")
    return f"{component.controller} ({', '.join(words)})"


def summary(state: SystemState) -> str:
    """Returns the health of the system in one line, with counts and faults of sources."""
    weight = state.weight
    if not state.is_heard:
        words = "nothing is heard"
    else:
        words = ("all is well", "look at the warnings", "something does not work")[weight]
    counts = f"{len(state.connections)} connections, {len(state.components)} components"
    faults = [f"{name}: {cell(fault, 200)}" for name, fault in state.sources.items() if fault]
    ignored = [f"{state.ignored} ignored"] if state.ignored else []
    return "; ".join([f"{words}; {counts}", *ignored, *faults])
