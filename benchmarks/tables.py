"""Tables of the pages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Returns a table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines) + "\n"


def _cell(value: object) -> str:
    if isinstance(value, float | int):
        return f"{value:,.0f}" if abs(value) >= 100 else f"{value:g}"
    return "" if value is None else str(value)


def times(figures: Mapping[str, Any]) -> str:
    """Returns a ratio with its span, or that it could not be measured."""
    if "ratio" not in figures:
        return ""
    ends = figures.get("span") or []
    ratio = f"{figures['ratio']:.2f}"
    return f"{ratio} ({ends[0]:.2f} to {ends[1]:.2f})" if ends else ratio
