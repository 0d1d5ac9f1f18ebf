"""What a merge of lines leaves in a file where both sides changed the same ones."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_MARKER = re.compile(rb"^(<{7}|={7}|>{7})(?:[ \r\n]|$)", re.MULTILINE)
_MOST_NAMED = 5

RULE = "JML009"
HINT = "keep what is meant, and remove the marks"


def unmerged(data: bytes) -> tuple[str, int]:
    """Returns what is said of all markers of conflicts, and the line of the first; empty for none.

    To be asked where a file cannot be read: some texts may hold such lines.
    """
    found = list(_conflicts(data))
    if not found:
        return "", 0
    places = [f"{first}-{last}" if last > first else f"{first}" for first, last in found]
    more = [f"and {len(places) - _MOST_NAMED} more"] if len(places) > _MOST_NAMED else []
    shown = ", ".join([*places[:_MOST_NAMED], *more])
    return f"an unmerged conflict stands in lines {shown}", found[0][0]


def _conflicts(data: bytes) -> Iterator[tuple[int, int]]:
    """Yields the first and the last line of each conflict."""
    first = last = at = 0
    line = 1
    for marker in _MARKER.finditer(data):
        line += data.count(b"\n", at, marker.start())
        at = marker.start()
        if first and marker[1].startswith(b"<"):
            yield first, last
            first = 0
        first, last = first or line, line
        if marker[1].startswith(b">"):
            yield first, last
            first = 0
    if first:
        yield first, last
