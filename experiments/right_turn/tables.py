"""Pieces of the page: numbers, tables and figures."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any


def number(value: float | str | None) -> str:
    """Returns a number with three digits, as many as mean something here; a text as it is."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    if not math.isfinite(value):
        return str(value)
    digits = max(2 - math.floor(math.log10(abs(value))), 0) if value else 0
    rounded = round(value, digits)
    return f"{rounded:,.0f}" if abs(rounded) >= 1000 else f"{rounded:g}"


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Returns a table; cells with a bar are written so that it is one cell."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines) + "\n"


def _cell(value: object) -> str:
    text = number(value) if isinstance(value, float | int | bool) else str(value or "")
    return text.replace("|", "\\|")


def figure(name: str, folder: str, words: str, data: Mapping[str, Any]) -> str:
    """Returns a figure, or nothing when it was not drawn."""
    return f"![{words}]({folder}/{name}.svg)\n" if name in data["figures"] else ""


def answer(claim: Mapping[str, Any]) -> str:
    """Returns whether a claim holds, in words; that it does not is meant to be seen."""
    return {True: "yes", False: "**no**", None: "not measured"}[claim["holds"]]
