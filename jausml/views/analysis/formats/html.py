"""Report as one HTML page that needs nothing else: no scripts, light and dark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from jausml.views.analysis.formats import text as words
from jausml.views.analysis.report import ConnectionReport, Load, Report
from jausml.views.pages import page

_SUMS = (
    "component",
    "host",
    "messages/s out",
    "in",
    "packets/s out",
    "in",
    "kB/s out",
    "in",
    "kB/s IP out",
    "in",
    "kB/s Ethernet out",
    "in",
)
_LOAD = (
    "connection",
    "JAUS message, ROS type",
    "Hz",
    "bytes",
    "ROS bytes",
    "packets/s",
    "kB/s in",
    "kB/s out",
    "CPU %",
)


_Cell: TypeAlias = "str | tuple[str, str]"
"""The text of a cell; of two lines the second is small."""


@dataclass(frozen=True)
class _Table:
    """A table with a bar at the end of each row: its load, as a share of the greatest."""

    head: Sequence[str]
    rows: Sequence[Sequence[_Cell]]
    loads: Sequence[Load]

    @property
    def bars(self) -> list[float]:
        octets = list(map(_octets, self.loads))
        longest = max(octets, default=0) or 1
        return [100 * octet / longest for octet in octets]


def render(report: Report) -> str:
    """Returns a report as a page."""
    sums = list(words.sums(report, ("judp", "ip", "ethernet")))
    loads = [component.load for component in report.components]
    loads += [host.load for host in report.hosts]
    bridges = []
    for bridge in report.bridges:
        heaviest = sorted(bridge.connections, key=lambda one: (-_octets(one.load), one.name))
        table = _Table(
            _LOAD, list(map(_row, heaviest)), [connection.load for connection in heaviest]
        )
        bridges.append((bridge, table, heaviest))
    known = {"report": report, "words": words, "bridges": bridges}
    known["sums"] = _Table(_SUMS, sums, loads)
    return page(__package__, "report", f"Load and times of {report.system}", known)


def _octets(load: Load) -> float:
    return load.sent.judp + load.received.judp


def _row(connection: ConnectionReport) -> tuple[_Cell, ...]:
    load = connection.load
    return (
        (connection.name, f"{words.WAYS[connection.direction]}, {connection.exchange}"),
        (connection.message, connection.type),
        words.rate(connection),
        words.sizes(connection),
        words.size(connection.ros.bytes),
        words.number(load.sent.packets + load.received.packets),
        words.kilobytes(load.received.judp),
        words.kilobytes(load.sent.judp),
        words.number(connection.share * 100),
    )
