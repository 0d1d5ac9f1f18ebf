"""Conflicts: whether another program has saved a file as if the last edit had not been."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.splices import applied, inverted

if TYPE_CHECKING:
    from jausml.authoring.editing.records import Entry, Stored


def takes_back(entry: Entry | None, known: Stored | None, new: bytes | None) -> bool:
    """Tells whether a file has the lines again that an edit has replaced, and none that it made."""
    if entry is None or known is None or new is None or entry.is_outside:
        return False
    for change in entry.changes:
        if change.file == known.file and change.after == known.digest:
            before = known.data
            for step in reversed(change.steps):
                before = applied(before, inverted(step))
            old, own, now = (set(each.splitlines()) for each in (before, known.data, new))
            return old != own and old - own <= now and not (own - old) & now
    return False
