"""Refs of earlier revisions: followed through what was done since."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.editing.batches import with_created
from jausml.editing.commands import Create, EditError, Place
from jausml.model import refs

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.editing.commands import Command
    from jausml.editing.records import Entry
    from jausml.model.refs import Ref

    Shift = Mapping[Ref, Ref]
    """New refs by old ones where they differ; empty for what is gone."""

_KEPT = 256


@dataclass(frozen=True, slots=True)
class _Passage:
    """What happened in one revision: to which files, and how refs shifted; None when unknown."""

    files: frozenset[str]
    shifts: tuple[Shift, ...] | None


class Rebasing:
    """Follows refs from one revision to the next, as long as it remembers."""

    def __init__(self) -> None:
        self._passages: OrderedDict[int, _Passage] = OrderedDict()
        self._shifts: OrderedDict[int, tuple[Shift, ...]] = OrderedDict()

    def note(self, revision: int, entry: Entry, shifts: Sequence[Shift]) -> None:
        """Remembers what commands did to refs."""
        self._shifts[entry.number] = tuple(shifts)
        self._pass(revision, entry, tuple(shifts))

    def note_again(self, revision: int, entry: Entry, *, back: bool) -> None:
        """Remembers that an entry was undone, or done again."""
        shifts = self._shifts.get(entry.number)
        if back and shifts is not None:
            shifts = tuple(_inverted(each) for each in reversed(shifts))
        self._pass(revision, entry, shifts)

    def note_unknown(self, revision: int, files: Iterable[str]) -> None:
        """Remembers that something was done to files of which nobody knows what it means."""
        self._passages[revision] = _Passage(frozenset(files), None)

    def rebased(self, command: Command, base: int, now: int) -> Command:
        """Returns a command with the present refs of its elements.

        Args:
            command: A command with the refs of an earlier revision.
            base: That revision.
            now: The present revision.

        Raises:
            EditError: What it speaks of is gone, or cannot be found again for certain.
        """
        if isinstance(command, Create | Place):
            return command
        passages = [self._passages.get(each) for each in range(base + 1, now + 1)]
        return with_created(command, lambda ref: _followed(ref, passages))

    def _pass(self, revision: int, entry: Entry, shifts: tuple[Shift, ...] | None) -> None:
        self._passages[revision] = _Passage(frozenset(entry.files), shifts)
        for kept in (self._passages, self._shifts):
            while len(kept) > _KEPT:
                kept.popitem(last=False)


def _followed(ref: Ref, passages: Sequence[_Passage | None]) -> Ref:
    file, _ = refs.split(ref)
    for each in passages:
        if file and (each is None or (each.shifts is None and file in each.files)):
            message = f"{file} has changed since: look at it again, and repeat the edit"
            raise EditError(message, conflict=True)
        for shift in (each.shifts if each is not None else None) or ():
            ref = shift.get(ref, ref)
            if not ref and file:
                raise EditError("what was to be changed is gone meanwhile", conflict=True)
    return ref


def _inverted(shift: Shift) -> Shift:
    return {new: old for old, new in shift.items() if new}
