"""The log of a project: what was done, what can be done again, and what others took back."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.records import Entry
from jausml.authoring.editing.splices import applied, inverted

if TYPE_CHECKING:
    from jausml.authoring.editing.records import FileChange, Stored
    from jausml.language.model.refs import Ref


class Log:
    """Entries in order, of which the first ones are done and the others undone."""

    def __init__(self) -> None:
        self._entries: list[Entry] = []
        self._at = 0
        self._count = 0

    @property
    def done(self) -> tuple[Entry, ...]:
        """What was done and not undone, in order."""
        return tuple(self._entries[: self._at])

    @property
    def undone(self) -> tuple[Entry, ...]:
        """What can be done again, the next first."""
        return tuple(self._entries[self._at :])

    @property
    def last(self) -> Entry | None:
        """What was done last, None without anything."""
        return self._entries[self._at - 1] if self._at else None

    @property
    def next(self) -> Entry | None:
        """What was undone last, None without anything."""
        return self._entries[self._at] if self._at < len(self._entries) else None

    def add(
        self,
        label: str,
        changes: tuple[FileChange, ...],
        created: tuple[Ref, ...] = (),
        *,
        is_outside: bool = False,
    ) -> Entry:
        """Adds what was done; what was undone before can no longer be done again."""
        self._count += 1
        entry = Entry(self._count, label, changes, created, is_outside)
        self._entries[self._at :] = [entry]
        self._at += 1
        return entry

    def extend(self, entry: Entry, changes: tuple[FileChange, ...]) -> Entry:
        """Makes changes part of the last entry; what was undone before it is gone already."""
        made = replace(entry, changes=changes)
        self._entries[self._at - 1 :] = [made]
        return made

    def step_back(self) -> None:
        """Notes that the last entry was undone."""
        self._at -= 1

    def step_on(self) -> None:
        """Notes that the next entry was done again."""
        self._at += 1


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
