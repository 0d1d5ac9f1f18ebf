"""Refs of earlier revisions: followed through what was done since."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from jausml.authoring.editing.batches import with_created
from jausml.authoring.editing.commands import Create, EditError, Place
from jausml.language.model import refs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.authoring.editing.commands import Add, Command, Move, Remove, Rename, Set
    from jausml.authoring.editing.outside import Outside
    from jausml.authoring.editing.records import Entry
    from jausml.language.model.refs import Ref

    Movable = Set | Add | Remove | Move | Rename
    Shift = Mapping[Ref, Ref]
    """New refs by old ones where they differ; empty for what is gone."""

_KEPT, _KEPT_OUTSIDE = 256, 32


@dataclass(frozen=True, slots=True)
class _Passage:
    """What happened in one revision.

    Attributes:
        shifts: How refs shifted; None when no commands say so.
    """

    files: frozenset[str]
    shifts: tuple[Shift, ...] | None
    outside: Callable[[], Outside] | None = None

    def past(self, command: Movable, *, is_first: bool) -> Movable:
        """Returns a command with the refs after what happened."""
        if self.outside is not None and self._concerns(command):
            return self.outside().followed(command, is_first=is_first)
        return with_created(command, self._followed)

    def _concerns(self, command: Movable) -> bool:
        named: list[Ref] = []

        def noted(ref: Ref) -> Ref:
            named.append(refs.split(ref)[0])
            return ref

        with_created(command, noted)
        return not self.files.isdisjoint(named)

    def _followed(self, ref: Ref) -> Ref:
        file, _ = refs.split(ref)
        if file in self.files and self.shifts is None and self.outside is None:
            raise _forgotten(file)
        for shift in self.shifts or ():
            ref = shift.get(ref, ref)
            if not ref and file:
                raise EditError("what was to be changed is gone meanwhile", conflict=True)
        return ref


class Rebasing:
    """Follows refs from one revision to the next, as long as it remembers."""

    def __init__(self) -> None:
        self._passages: OrderedDict[int, _Passage] = OrderedDict()
        self._shifts: OrderedDict[int, tuple[Shift, ...]] = OrderedDict()

    def note(self, revision: int, entry: Entry, shifts: Sequence[Shift]) -> None:
        """Remembers what commands did to refs."""
        self._shifts[entry.number] = tuple(shifts)
        self._pass(revision, entry, tuple(shifts))

    def note_again(self, revision: int, entry: Entry, *, back: bool) -> bool:
        """Remembers that an entry was undone, or done again; tells whether commands say how."""
        shifts = self._shifts.get(entry.number)
        if back and shifts is not None:
            shifts = tuple(_inverted(each) for each in reversed(shifts))
        self._pass(revision, entry, shifts)
        return shifts is not None

    def note_outside(self, revision: int, file: str, outside: Callable[[], Outside]) -> None:
        """Remembers that something was done to a file that no commands say."""
        self._passages[revision] = _Passage(frozenset([file]), None, cache(outside))
        # Each has the files before and after: more than a few would need much memory.
        held = [number for number, each in self._passages.items() if each.outside is not None]
        for number in held[:-_KEPT_OUTSIDE]:
            self._passages[number] = replace(self._passages[number], outside=None)
        self._forget()

    def rebased(self, command: Command, base: int, now: int, *, is_first: bool = True) -> Command:
        """Returns a command with the present refs of its elements."""
        if isinstance(command, Create | Place):
            return command
        for revision in range(base + 1, now + 1):
            passage = self._passages.get(revision)
            if passage is None:
                raise _forgotten("the model")
            command = passage.past(command, is_first=is_first)
        return command

    def _pass(self, revision: int, entry: Entry, shifts: tuple[Shift, ...] | None) -> None:
        self._passages[revision] = _Passage(frozenset(entry.files), shifts)
        self._forget()

    def _forget(self) -> None:
        for kept in (self._passages, self._shifts):
            while len(kept) > _KEPT:
                kept.popitem(last=False)


def _forgotten(what: str) -> EditError:
    message = f"{what} has changed since: look at it again, and repeat the edit"
    return EditError(message, conflict=True)


def _inverted(shift: Shift) -> Shift:
    return {new: old for old, new in shift.items() if new}
