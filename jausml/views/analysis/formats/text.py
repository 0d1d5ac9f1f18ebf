"""Report as text, of no more than a hundred columns, and its words and numbers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.views.analysis.budgets import Budget
from jausml.views.analysis.report import CallReport, ComponentReport, ConnectionReport, Report
from jausml.views.analysis.sizes import Assumptions, Size

CASES = {
    "normal": "normal",
    "queue_full": "queue full",
    "one_lost_packet": "one lost packet",
    "source_dead": "source dead",
    "controller_dead": "controller dead",
}
"""The cases of budgets, as they are called."""

WAYS = {TO_ROS: "to ROS", TO_JAUS: "to JAUS"}


def size(bounds: Size) -> str:
    """Returns the bounds of a size, such as `12..26`; `+` for no limit."""
    if bounds.most is None:
        return f"{bounds.least}+"
    return str(bounds.least) if bounds.least == bounds.most else f"{bounds.least}..{bounds.most}"


def sizes(connection: ConnectionReport) -> str:
    """Returns the bounds of the greatest message that a connection carries."""
    if not connection.flows:
        return "-"
    return size(
        max((flow.size for flow in connection.flows), key=lambda flow_size: flow_size.expected)
    )


def rate(connection: ConnectionReport) -> str:
    """Returns the rate of a connection; `~` before one that is assumed."""
    flows = [flow for flow in connection.flows if flow.kind != "query"]
    if not flows:
        return "-"
    fastest = max(flows, key=lambda flow: flow.hertz)
    return f"{'~' if fastest.basis == 'assumed' else ''}{fastest.hertz:g}"


def call(report: CallReport) -> str:
    """Returns a connection with a ROS service or action, in a sentence."""
    messages, peers = ", ".join(report.messages), ", ".join(report.peers) or "anybody"
    what = f"{report.kind} {report.ros_name} ({report.type}) {WAYS[report.direction]}"
    return f"{report.name}: {what}; {messages}; {peers}; an answer within {report.seconds:g} s"


def ends(connection: ConnectionReport) -> str:
    """Returns the peers of a connection, and its topics."""
    peers = ", ".join(connection.peers) or "nobody"
    joins = (f"{join} (joined)" for join in connection.joins)
    return f"{peers}; {', '.join((*connection.topics, *joins))}"


def sums(report: Report, layers: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yields name, host and figures of each component and host: sent and received in turn."""
    rows = [
        (component.name, component.host or "-", component.load) for component in report.components
    ]
    rows += [
        (f"host {host_report.name}", host_report.transport, host_report.load)
        for host_report in report.hosts
    ]
    for name, host, load in rows:
        both = load.sent, load.received
        figures = [number(load.messages_sent), number(load.messages_received)]
        figures += [number(wire.packets) for wire in both]
        figures += [kilobytes(getattr(wire, layer)) for layer in layers for wire in both]
        yield (name, host, *figures)


def kilobytes(octets: float) -> str:
    """Returns bytes in thousands, with three digits."""
    return number(octets / 1000)


def number(value: float) -> str:
    """Returns a number with three digits, without an exponent."""
    if value == 0:
        return "0"
    digits = 0 if value >= 100 else 1 if value >= 10 else 2
    return f"{value:.{digits}f}"


def time(budget: Budget) -> str:
    """Returns the sum of a budget."""
    return "no bound" if budget.seconds is None else f"{budget.seconds:.3f} s"


def steps(budget: Budget) -> str:
    """Returns the steps of a budget, or why it has no bound."""
    if budget.never:
        return budget.never
    named = (f"{step.name}: {step.seconds:.3f}" for step in budget.steps)
    return " + ".join(named) or "passed on at once"


def notes(assumptions: Assumptions) -> list[str]:
    """Returns the assumptions under the figures."""
    special = [
        *(f"{name} {value:g} Hz" for name, value in sorted(assumptions.rates.items())),
        *(f"{name} {value} elements" for name, value in sorted(assumptions.lengths.items())),
    ]
    return [
        f"~ is an assumed rate: {assumptions.rate:g} Hz where a model states none (--assume-rate).",
        f"Lists without a bound have {assumptions.length} elements (--assume-length); optional "
        "fields that may be there are. + after a size: nothing but the receiver limits it.",
        *([f"Assumed besides: {', '.join(special)}."] if special else []),
        "Bytes are those of UDP payload: the version byte, 14 bytes of header and number, the "
        "message; IP adds 28 to each datagram, and more where it cuts one; Ethernet 38 a frame.",
        "Sums have acknowledgements, renewals of events and control. Not in them: searches, "
        "registration, the start, calls of ROS services and actions, and what TCP adds.",
        "Times are worst cases of what the model decides; network and processors come on top.",
        "CPU is a share of one processor by the figures of a benchmark: it tells bridges apart.",
    ]


WIDTH = 100

_NAME = 22
_MESSAGE = 20
_LOAD = (
    "connection",
    "way",
    "exchange",
    "Hz",
    "bytes",
    "peers",
    "pkt/s",
    "kB/s in",
    "out",
    "CPU %",
)
_LEFT = 3
_SUMS = (
    "component",
    "host",
    "msg/s out",
    "in",
    "pkt/s out",
    "in",
    "kB/s out",
    "in",
    "IP out",
    "in",
)
_LEFT_OF_SUMS = 2


def render(report: Report) -> str:
    """Returns a report as text."""
    return "\n".join(line.rstrip() for line in _lines(report)) + "\n"


def _lines(report: Report) -> Iterator[str]:
    yield f"system {cut(report.system, WIDTH - 7)}"
    yield ""
    rows = [
        (cut(name, _NAME), cut(host, _MESSAGE - 6), *figures)
        for name, host, *figures in sums(report, ("judp", "ip"))
    ]
    yield from table(_SUMS, rows, _LEFT_OF_SUMS)
    for component in report.components:
        for warning in component.warnings:
            yield from wrapped(f"warning: {component.name}: {warning}", "")
    for bridge in report.bridges:
        yield ""
        yield from _bridge(bridge)
    yield ""
    if report.changes:
        yield "With other bridges (jausml new partition proposes them):"
        for change in report.changes:
            yield from wrapped(change, "  ")
        yield ""
    for note in notes(report.assumptions):
        yield from wrapped(note, "")


def _bridge(bridge: ComponentReport) -> Iterator[str]:
    share = number(bridge.share * 100)
    yield f"bridge {cut(bridge.name, _NAME)} ({bridge.address}), {share} % of a processor"
    yield ""
    yield from table(_LOAD, [_row(connection) for connection in bridge.connections], _LEFT)
    for connection in bridge.connections:
        yield ""
        yield from _details(connection)
    for served in bridge.calls:
        yield ""
        yield from wrapped(call(served), "  ")


def _row(connection: ConnectionReport) -> tuple[str, ...]:
    load = connection.load
    return (
        cut(connection.name, _NAME),
        WAYS[connection.direction],
        connection.exchange.replace(" event", ""),
        rate(connection),
        sizes(connection),
        str(len(connection.peers)),
        number(load.sent.packets + load.received.packets),
        kilobytes(load.received.judp),
        kilobytes(load.sent.judp),
        number(connection.share * 100),
    )


def _details(connection: ConnectionReport) -> Iterator[str]:
    ros = size(connection.ros.bytes)
    named = f"{connection.message} and {connection.type} ({ros} bytes)"
    yield from wrapped(f"{connection.name}: {named}; {ends(connection)}", "  ")
    for budget in connection.budgets:
        head = f"{CASES[budget.case]:<15} {time(budget):>9}  "
        yield from wrapped(f"{steps(budget)}", f"    {head}")
    for warning in connection.warnings:
        yield from wrapped(f"warning: {warning}", "    ")


def wrapped(text: str, first: str) -> Iterator[str]:
    """Yields lines of a text, the first after another one."""
    yield from textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=" " * max(len(first), 2)
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> Iterator[str]:
    """Yields the lines of a table, of which so many columns stand at their left."""
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    for row in (head, *rows):
        cells = [
            cell.ljust(width) if index < left else cell.rjust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield "  ".join(cells)


def cut(text: str, width: int) -> str:
    """Returns the beginning of a text that is too long."""
    return text if len(text) <= width else f"{text[: width - 3]}..."
