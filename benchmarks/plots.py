"""Plots as SVG, written by hand so that they depend on nothing but the figures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_COLOURS = {
    "relay": "#93b98a",
    "floor": "#3f7a2a",
    "compiled": "#6b3f9e",
    "generated": "#2b5f8f",
    "light": "#2b5f8f",
    "typed": "#a9730f",
    "generic": "#8a8a8a",
}
_WIDTH, _LEFT, _RIGHT, _TOP, _BOTTOM = 760, 170, 60, 64, 34
_BAR, _GAP, _PANEL_GAP = 11, 10, 28
_PLAIN = (1, 2, 5)
_MOST_TICKS = 12


@dataclass(frozen=True)
class Panel:
    """A group of bars under one heading.

    Attributes:
        heading: What stands above it.
        bars: Values by row and series; what is None has no bar.
    """

    heading: str
    bars: Mapping[str, Mapping[str, float | None]]


def bars(
    title: str, unit: str, series: Sequence[str], panels: Sequence[Panel], mark: float | None = None
) -> str:
    """Returns a plot of horizontal bars on a logarithmic axis.

    Args:
        title: What is shown.
        unit: What the axis counts.
        series: Names of the series, in the order of the bars of a row.
        panels: What stands below each other.
        mark: A value with a line, such as a target.
    """
    values = [
        value
        for panel in panels
        for row in panel.bars.values()
        for value in row.values()
        if value is not None
    ]
    low, high = _limits([*values, *([mark] if mark is not None else [])])
    row_height = _BAR * len(series) + _GAP
    height = _TOP + _BOTTOM + sum(_PANEL_GAP + row_height * len(each.bars) for each in panels)
    plot = _Plot(low, high, height)
    parts = [*_head(title, series, height), *plot.axis(unit)]
    y = float(_TOP)
    for panel in panels:
        y += _PANEL_GAP
        parts.append(f'<text class="h" x="12" y="{y - 8:g}">{escape(panel.heading)}</text>')
        for name, row in panel.bars.items():
            parts.append(
                f'<text class="e" x="{_LEFT - 8}" y="{y + _BAR * len(series) / 2 + 4:g}">'
                f"{escape(name)}</text>"
            )
            for number, each in enumerate(series):
                value = row.get(each)
                if value is not None:
                    parts += plot.bar(y + number * _BAR, value, _COLOURS[each])
            y += row_height
    if mark is not None:
        x = plot.x(mark)
        parts.append(f'<path class="m" d="M{x:.1f} {_TOP}V{height - _BOTTOM}"/>')
    return "\n".join([*parts, "</svg>", ""])


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:g}"


class _Plot:
    def __init__(self, low: float, high: float, height: float) -> None:
        self._low, self._high, self._height = low, high, height

    def x(self, value: float) -> float:
        share = math.log(value / self._low) / math.log(self._high / self._low)
        return _LEFT + min(max(share, 0.0), 1.0) * (_WIDTH - _LEFT - _RIGHT)

    def bar(self, y: float, value: float, colour: str) -> list[str]:
        x = self.x(value)
        return [
            f'<rect x="{_LEFT}" y="{y:g}" width="{max(x - _LEFT, 1):.1f}" height="{_BAR - 1}"'
            f' fill="{colour}"/>',
            f'<text class="v" x="{x + 4:.1f}" y="{y + _BAR - 2:g}">{_short(value)}</text>',
        ]

    def axis(self, unit: str) -> list[str]:
        bottom = self._height - _BOTTOM
        parts = []
        ticks = _ticks(self._low, self._high)
        if len(ticks) > _MOST_TICKS:
            ticks = [value for value in ticks if math.log10(value).is_integer()]
        for value in ticks:
            x = self.x(value)
            parts.append(f'<path class="g" d="M{x:.1f} {_TOP}V{bottom:g}"/>')
            parts.append(f'<text class="t" x="{x:.1f}" y="{bottom + 14:g}">{_short(value)}</text>')
        middle = (_LEFT + _WIDTH - _RIGHT) / 2
        parts.append(f'<text class="t" x="{middle:g}" y="{bottom + 29:g}">{escape(unit)}</text>')
        return parts


def _head(title: str, series: Sequence[str], height: float) -> list[str]:
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height:g}"'
        f' font-family="sans-serif" font-size="12" role="img" aria-label="{escape(title)}">',
        "<style>.h{font-weight:bold}.t{text-anchor:middle;fill:#444}.e{text-anchor:end}"
        ".v{font-size:9px;fill:#444}.g{stroke:#ddd}"
        ".m{stroke:#b02a2a;stroke-width:1.5;stroke-dasharray:5 3}</style>",
        f'<rect width="{_WIDTH}" height="{height:g}" fill="#fff"/>',
        f'<text class="h" x="12" y="20" font-size="14">{escape(title)}</text>',
    ]
    x = 12.0
    for each in series:
        parts.append(f'<rect x="{x:g}" y="34" width="10" height="10" fill="{_COLOURS[each]}"/>')
        parts.append(f'<text x="{x + 15:g}" y="43">{escape(each)}</text>')
        x += 40 + 7 * len(each)
    return parts


def _limits(values: Sequence[float]) -> tuple[float, float]:
    """Returns plain numbers below and above all values."""
    low, high = min(values), max(values)
    below = [tick for tick in _ticks(low / 10, low) if tick < low]
    above = [tick for tick in _ticks(high, high * 10) if tick > high]
    return below[-1], above[0]


def _ticks(low: float, high: float) -> list[float]:
    """Returns 1, 2, 5, 10, ... within limits."""
    found = []
    for power in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1):
        found += [plain * 10.0**power for plain in _PLAIN]
    return [each for each in found if low * 0.999 <= each <= high * 1.001]
