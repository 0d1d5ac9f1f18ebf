"""What a merge of lines leaves in files: the markers of conflicts that nobody has settled."""

from __future__ import annotations

import re
from collections.abc import Iterator

_MARKER = re.compile(rb"^(<{7}|={7}|>{7})(?:[ \r\n]|$)", re.MULTILINE)
_MOST_NAMED = 5

UNMERGED = "JML009"
UNMERGED_HINT = "keep what is meant, and remove the marks"


def unmerged(data: bytes) -> tuple[str, int]:
    """Returns a remark on all markers of conflicts, and the line of the first; empty for none.

    To be asked where a file cannot be read: some texts may hold such lines.
    """
    conflicts = list(_conflicts(data))
    if not conflicts:
        return "", 0
    places = [f"{first}-{last}" if last > first else f"{first}" for first, last in conflicts]
    more = [f"and {len(places) - _MOST_NAMED} more"] if len(places) > _MOST_NAMED else []
    shown = ", ".join([*places[:_MOST_NAMED], *more])
    return f"an unmerged conflict stands in lines {shown}", conflicts[0][0]


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
