"""Report as text, of no more than a hundred columns."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from jausml.views.analysis.formats import words

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.views.analysis.report import ComponentReport, ConnectionReport, Load, Report

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
    yield f"system {_cut(report.system, WIDTH - 7)}"
    yield ""
    rows = [_sum_row(each.name, each.host or "-", each.load) for each in report.components]
    rows += [_sum_row(f"host {each.name}", each.transport, each.load) for each in report.hosts]
    yield from _table(_SUMS, rows, _LEFT_OF_SUMS)
    for component in report.components:
        for warning in component.warnings:
            yield from _wrapped(f"warning: {component.name}: {warning}", "")
    for each in report.bridges:
        yield ""
        yield from _bridge(each)
    yield ""
    for note in words.notes(report.assumptions):
        yield from _wrapped(note, "")


def _sum_row(name: str, host: str, load: Load) -> tuple[str, ...]:
    return (
        _cut(name, _NAME),
        _cut(host, _MESSAGE - 6),
        words.number(load.messages_sent),
        words.number(load.messages_received),
        words.number(load.sent.packets),
        words.number(load.received.packets),
        words.kilobytes(load.sent.judp),
        words.kilobytes(load.received.judp),
        words.kilobytes(load.sent.ip),
        words.kilobytes(load.received.ip),
    )


def _bridge(bridge: ComponentReport) -> Iterator[str]:
    share = words.number(bridge.share * 100)
    yield f"bridge {_cut(bridge.name, _NAME)} ({bridge.address}), {share} % of a processor"
    yield ""
    yield from _table(_LOAD, [_row(each) for each in bridge.connections], _LEFT)
    for each in bridge.connections:
        yield ""
        yield from _details(each)
    for call in bridge.calls:
        yield ""
        yield from _wrapped(words.call(call), "  ")


def _row(connection: ConnectionReport) -> tuple[str, ...]:
    load = connection.load
    return (
        _cut(connection.name, _NAME),
        words.WAYS[connection.direction],
        connection.exchange.replace(" event", ""),
        words.rate(connection),
        words.sizes(connection),
        str(len(connection.peers)),
        words.number(load.sent.packets + load.received.packets),
        words.kilobytes(load.received.judp),
        words.kilobytes(load.sent.judp),
        words.number(connection.share * 100),
    )


def _details(connection: ConnectionReport) -> Iterator[str]:
    ends = f"{connection.message} and {connection.type}"
    peers = ", ".join(connection.peers) or "nobody"
    topics = ", ".join((*connection.topics, *(f"{each} (joined)" for each in connection.joins)))
    ros = words.size(connection.ros_size)
    yield from _wrapped(f"{connection.name}: {ends} ({ros} bytes); {peers}; {topics}", "  ")
    for budget in connection.budgets:
        head = f"{words.CASES[budget.case]:<15} {words.time(budget):>9}  "
        yield from _wrapped(f"{words.steps(budget)}", f"    {head}")
    for warning in connection.warnings:
        yield from _wrapped(f"warning: {warning}", "    ")


def _wrapped(text: str, first: str) -> Iterator[str]:
    yield from textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=" " * max(len(first), 2)
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    for row in (head, *rows):
        cells = [
            cell.ljust(width) if index < left else cell.rjust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield "  ".join(cells)


def _cut(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: width - 3]}..."
