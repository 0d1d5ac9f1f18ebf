"""Report as one HTML page that needs nothing else: no scripts, light and dark."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from typing import TYPE_CHECKING, TypeAlias

from jausml.views.analysis.formats import text as words
from jausml.views.pages import page_head

if TYPE_CHECKING:
    from jausml.views.analysis.report import ComponentReport, ConnectionReport, Load, Report

_STYLE = """\
:root { color-scheme: light dark; --ink: #1a1a1a; --ground: #fff; --line: #d0d0d0; --bar: #4a7fb5;
  --soft: #666; --alarm: #a33; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e4e4; --ground: #16181b; --line: #3a3d42; --bar: #6aa3dc; --soft: #a0a0a0;
    --alarm: #ff8a80; } }
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--ground);
  margin: 2rem auto; max-width: 75rem; padding: 0 1rem; }
h1, h2 { font-weight: 600; } h2 { margin-top: 2.5rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: .3rem .6rem; border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--soft); vertical-align: bottom; }
td small { display: block; color: var(--soft); }
th.text, td.text { text-align: left; }
td.bar { min-width: 6rem; }
td.bar span { display: block; height: .7rem; background: var(--bar); border-radius: 2px; }
details { margin: .4rem 0; } summary { cursor: pointer; }
.alarm { color: var(--alarm); } .soft { color: var(--soft); }
"""

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
"""What stands in a cell; of two lines the second is small."""


def render(report: Report) -> str:
    """Returns a report as a page."""
    return "\n".join(_lines(report)) + "\n"


def _lines(report: Report) -> Iterator[str]:
    yield page_head(f"Load and times of {report.system}", _STYLE)
    rows = [(each.name, each.host or "-", each.load) for each in report.components]
    rows += [(f"host {each.name}", each.transport, each.load) for each in report.hosts]
    yield from _table(_SUMS, 2, _sums(rows))
    for component in report.components:
        yield from _alarms(f"{component.name}: {each}" for each in component.warnings)
    for bridge in report.bridges:
        yield from _bridge(bridge)
    yield "<h2>What the figures stand on</h2>\n<ul>"
    yield from (f"<li>{escape(note)}</li>" for note in words.notes(report.assumptions))
    yield "</ul>\n</body>\n</html>"


def _sums(rows: Iterable[tuple[str, str, Load]]) -> Iterator[tuple[Sequence[str], float]]:
    for name, host, load in rows:
        figures = [words.number(load.messages_sent), words.number(load.messages_received)]
        figures += [words.number(load.sent.packets), words.number(load.received.packets)]
        for layer in ("judp", "ip", "ethernet"):
            figures += [
                words.kilobytes(getattr(each, layer)) for each in (load.sent, load.received)
            ]
        yield (name, host, *figures), load.sent.judp + load.received.judp


def _bridge(bridge: ComponentReport) -> Iterator[str]:
    yield f"<h2>Bridge {escape(bridge.name)}</h2>"
    share = words.number(bridge.share * 100)
    yield f'<p class="soft">{escape(bridge.address)}, {share} % of a processor</p>'
    heaviest = sorted(bridge.connections, key=lambda each: (-_octets(each), each.name))
    yield from _table(_LOAD, 2, ((_row(each), _octets(each)) for each in heaviest))
    for each in heaviest:
        yield from _details(each)
    yield from (f"<p>{escape(words.call(each))}</p>" for each in bridge.calls)


def _octets(connection: ConnectionReport) -> float:
    return connection.load.sent.judp + connection.load.received.judp


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


def _details(connection: ConnectionReport) -> Iterator[str]:
    peers = ", ".join(connection.peers) or "nobody"
    topics = ", ".join((*connection.topics, *(f"{each} (joined)" for each in connection.joins)))
    yield f"<details><summary>{escape(connection.name)}: times in the worst case</summary>"
    yield f'<p class="soft">{escape(f"with {peers}; {topics}")}</p>'
    yield '<div class="wide"><table>'
    for budget in connection.budgets:
        cells = (words.CASES[budget.case], words.time(budget), words.steps(budget))
        first, second, third = map(escape, cells)
        row = f'<td class="text">{first}</td><td>{second}</td><td class="text">{third}</td>'
        yield f"<tr>{row}</tr>"
    yield "</table></div></details>"
    yield from _alarms(f"{connection.name}: {each}" for each in connection.warnings)


def _alarms(texts: Iterable[str]) -> Iterator[str]:
    yield from (f'<p class="alarm">{escape(text)}</p>' for text in texts)


def _table(
    head: Sequence[str], left: int, rows: Iterable[tuple[Sequence[_Cell], float]]
) -> Iterator[str]:
    """Yields a table with bars at its right end."""
    known = list(rows)
    longest = max((length for _, length in known), default=0) or 1
    yield '<div class="wide"><table>'
    titles = (f"<th{_kind(index, left)}>{escape(text)}</th>" for index, text in enumerate(head))
    yield f"<tr>{''.join(titles)}<th></th></tr>"
    for cells, length in known:
        row = "".join(
            f"<td{_kind(index, left)}>{_content(cell)}</td>" for index, cell in enumerate(cells)
        )
        width = 100 * length / longest
        yield f'<tr>{row}<td class="bar"><span style="width: {width:.1f}%"></span></td></tr>'
    yield "</table></div>"


def _content(cell: _Cell) -> str:
    if isinstance(cell, str):
        return escape(cell)
    first, second = map(escape, cell)
    return f"{first}<small>{second}</small>"


def _kind(index: int, left: int) -> str:
    return ' class="text"' if index < left else ""
