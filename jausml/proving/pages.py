"""Results of proofs as pages: one for each map, with pictures of the errors, and a list of them."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

from jausml.proving.results import told, unit_of
from jausml.views.pages import hashed, page_head

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.proving.results import FieldResult, MapResult

_STYLE = """
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; }
body { margin: 2rem auto; max-width: 60rem; padding: 0 1rem; }
section { border-top: 1px solid #8886; padding: .6rem 0; }
h2 { font-size: 1.05rem; margin: 0; }
p { margin: .3rem 0; overflow-wrap: anywhere; }
svg { display: block; width: 100%; height: auto; }
.error { fill: #c0392b; }
.frame { fill: none; stroke: #888; }
.limit { stroke: #2471a3; stroke-dasharray: 6 4; }
text { fill: currentColor; font-size: 12px; }
.fail { color: #c0392b; font-weight: 600; }
"""
_LONGEST = 100
_WIDTH, _HEIGHT, _TOP, _BELOW = 720, 150, 18, 24


def pages(
    results: Sequence[MapResult], faults: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, str]]:
    """Yields the names and texts of the pages."""
    files = dict.fromkeys(["index.html"])
    rows = []
    for each in results:
        file = _file(each.name, files)
        link = f'<a href="{file}">{escape(each.name)}</a>'
        rows.append(f"<p>{link}: {_summary(each, faults)}</p>")
        yield file, _page(each.name, "\n".join(_map(each, faults)))
    yield "index.html", _page("Proofs", "\n".join(rows))


def _file(name: str, taken: dict[str, None]) -> str:
    """Returns the name of the file for a page, whatever maps are called."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)[:_LONGEST] or "map"
    file, count = f"{plain}.html", 2
    while file.lower() in taken:
        file, count = f"{plain}_{count}.html", count + 1
    taken[file.lower()] = None
    return file


def _summary(result: MapResult, faults: Mapping[str, Sequence[str]]) -> str:
    count = len(faults.get(result.name, ()))
    if count:
        return f'<span class="fail">{count} findings</span>'
    if result.error:
        return '<span class="fail">not proved</span>'
    tried = sum(each.tried for each in result.fields)
    return f"{len(result.fields)} numbers, {tried:,} values, no findings"


def _map(result: MapResult, faults: Mapping[str, Sequence[str]]) -> Iterator[str]:
    yield f"<p>JAUS {escape(result.message)}, ROS {escape(result.type)}</p>"
    for fault in faults.get(result.name, ()):
        yield f'<p class="fail">{escape(fault)}</p>'
    for each in result.fields:
        yield f"<section><h2>{each.side} {escape(each.path)}</h2>"
        yield f"<p>{escape(told(each))}</p>"
        yield from _picture(each)
        yield "</section>"
    for title, texts in (("Not carried", result.not_carried), ("Remarks", result.remarks)):
        if texts:
            yield f"<section><h2>{title}</h2><p>{escape(', '.join(texts))}</p></section>"


def _picture(each: FieldResult) -> Iterator[str]:
    """Yields the errors over the values, in their order, as bars."""
    most = max((value for value in each.bins if value != float("inf")), default=0.0)
    if not most:
        return
    bars = each.bins[: min(len(each.bins), each.total)]
    wide = _WIDTH / len(bars)
    shown = max(most, each.precision)
    bottom = _TOP + _HEIGHT
    yield f'<svg viewBox="0 0 {_WIDTH} {bottom + _BELOW}" role="img" aria-label="errors">'
    yield f'<rect class="frame" x="0" y="{_TOP}" width="{_WIDTH}" height="{_HEIGHT}"/>'
    for at, value in enumerate(bars):
        high = min(value / shown, 1.0) * _HEIGHT
        if high:
            place = f'x="{at * wide:.2f}" y="{bottom - high:.2f}"'
            size = f'width="{max(wide, 1):.2f}" height="{high:.2f}"'
            yield f'<rect class="error" {place} {size}/>'
    if each.precision:
        y = f"{bottom - _HEIGHT * each.precision / shown:.2f}"
        yield f'<line class="limit" x1="0" y1="{y}" x2="{_WIDTH}" y2="{y}"/>'
    low, high = each.ends
    order = "" if each.step else ", in the order of the values that the type has"
    yield _text(0, _TOP - 5, f"error up to {shown:.3g}{unit_of(each)}{order}")
    yield _text(0, bottom + 16, f"{low:.6g}{unit_of(each)}")
    yield _text(_WIDTH, bottom + 16, f"{high:.6g}{unit_of(each)}", "end")
    yield "</svg>"


def _text(x: float, y: float, text: str, anchor: str = "start") -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}">{escape(text)}</text>'


def _page(title: str, body: str) -> str:
    beginning = page_head(title, _STYLE, f"default-src 'none'; style-src {hashed(_STYLE)}")
    return f"{beginning}\n{body}\n</body>\n</html>\n"
