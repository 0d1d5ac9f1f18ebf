"""Tables of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from names import KINDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Returns a table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines) + "\n"


def _cell(value: object) -> str:
    if isinstance(value, float | int):
        return f"{value:,.0f}" if abs(value) >= 100 else f"{value:g}"
    return "" if value is None else str(value)


def times(figures: Mapping[str, Any], name: str = "ratio", span: str = "span") -> str:
    """Returns a ratio with its span, or that it could not be measured."""
    if name not in figures:
        return ""
    ends = figures.get(span) or []
    told = f"{figures[name]:.2f}"
    return f"{told} ({ends[0]:.2f} to {ends[1]:.2f})" if ends else told


def among(order: Iterable[str], measured: Sequence[Mapping[str, Any]]) -> list[str]:
    """Returns which variants or forms were measured in some case, in their order."""
    return [each for each in order if any(each in found for found in measured)]


def counted(found: Mapping[str, Any]) -> list[tuple[int, Any]]:
    """Returns what was found by number, in order."""
    return sorted((int(count), each) for count, each in found.items())


def by_kind(found: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Returns what was found by kind of message, in their order."""
    return [(kind, found[kind]) for kind in KINDS if kind in found]
