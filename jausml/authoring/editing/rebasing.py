"""Rebasing: refs of earlier revisions, followed through later changes, also of other programs."""

from __future__ import annotations

from collections import OrderedDict, defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain
from typing import Any, TypeAlias

from jausml.authoring.editing.commands import (
    Command,
    Create,
    EditError,
    ElementCommand,
    Place,
    Remove,
    Rename,
    Set,
    with_created,
)
from jausml.authoring.editing.records import Entry
from jausml.authoring.editing.working_copy import ElementCopy, WorkingCopy
from jausml.language.model import refs
from jausml.language.model.refs import Ref

Shift: TypeAlias = "Mapping[Ref, Ref]"
"""New refs by old ones where they differ; empty for removed elements."""

_KEPT, _KEPT_OUTSIDE = 256, 32

_NAME = "name"


@dataclass(frozen=True, slots=True)
class _Revision:
    """The changes of one revision.

    `shifts`: shifts of refs; None for changes without known commands.
    """

    files: frozenset[str]
    shifts: tuple[Shift, ...] | None
    outside: Callable[[], OutsideChange] | None = None

    def past(self, command: ElementCommand, *, is_first: bool) -> ElementCommand:
        """Returns a command with the refs after the changes."""
        # Comparing two states of a file is costly, and most commands concern another one.
        if self.outside is not None and self._concerns(command):
            return self.outside().followed(command, is_first=is_first)
        return with_created(command, self._followed)

    def _concerns(self, command: ElementCommand) -> bool:
        named: list[Ref] = []

        # with_created visits all refs of a command; here they are noted on the way.
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
            # An empty ref names no element, which could not be removed.
            if not ref and file:
                raise EditError("what was to be changed is gone meanwhile", conflict=True)
        return ref


class Rebasing:
    """Follows refs from one revision to the next, for the last revisions."""

    def __init__(self) -> None:
        self._revisions: OrderedDict[int, _Revision] = OrderedDict()
        self._shifts: OrderedDict[int, tuple[Shift, ...]] = OrderedDict()

    def note(self, revision: int, entry: Entry, shifts: Sequence[Shift]) -> None:
        """Keeps the shifts of refs by commands."""
        self._shifts[entry.number] = tuple(shifts)
        self._pass(revision, entry, tuple(shifts))

    def note_again(self, revision: int, entry: Entry, *, back: bool) -> bool:
        """Keeps that an entry was undone or redone; tells whether its shifts are known."""
        shifts = self._shifts.get(entry.number)
        if back and shifts is not None:
            # The last shift was made on top of the others, so it is undone first. A removed element
            # has no new ref that could lead back.
            shifts = tuple(
                {new: old for old, new in shift.items() if new} for shift in reversed(shifts)
            )
        self._pass(revision, entry, shifts)
        return shifts is not None

    def note_outside(self, revision: int, file: str, outside: Callable[[], OutsideChange]) -> None:
        """Keeps a change of a file without known commands."""
        self._revisions[revision] = _Revision(frozenset([file]), None, cache(outside))
        # Each has the files before and after: many would need much memory.
        held = [number for number, entry in self._revisions.items() if entry.outside is not None]
        for number in held[:-_KEPT_OUTSIDE]:
            self._revisions[number] = replace(self._revisions[number], outside=None)
        self._forget()

    def rebased(self, command: Command, base: int, now: int, *, is_first: bool = True) -> Command:
        """Returns a command with the present refs of its elements."""
        if isinstance(command, Create | Place):
            return command
        for revision in range(base + 1, now + 1):
            change = self._revisions.get(revision)
            if change is None:
                raise _forgotten("the model")
            command = change.past(command, is_first=is_first)
        return command

    def _pass(self, revision: int, entry: Entry, shifts: tuple[Shift, ...] | None) -> None:
        self._revisions[revision] = _Revision(frozenset(entry.files), shifts)
        self._forget()

    def _forget(self) -> None:
        for kept in (self._revisions, self._shifts):
            while len(kept) > _KEPT:
                kept.popitem(last=False)


def _forgotten(what: str) -> EditError:
    message = f"{what} has changed since: look at it again, and repeat the edit"
    return EditError(message, conflict=True)


class OutsideChange:
    """A change of a file of which only the states before and after are known.

    An element is the same if it has the same names up to its root. An element without a name is
    found only if its contents are unchanged, since positions prove nothing.
    """

    def __init__(self, file: str, before: WorkingCopy, after: WorkingCopy) -> None:
        self._file = file
        self._old = {ref: copy for copy, ref in before.refs().items()}
        self._refs = after.refs()
        self._contents: dict[ElementCopy, Hashable] = {}
        self._same: dict[ElementCopy, ElementCopy] = {}
        old, new = before.roots[file], after.roots[file]
        if len(old) == len(new) == 1 and old[0].table is new[0].table:
            # The only root is the same, also with another name.
            self._same[old[0]] = new[0]
            old, new = _owned(old[0]), _owned(new[0])
        self._pair(old, new)

    def followed(self, command: ElementCommand, *, is_first: bool = True) -> ElementCommand:
        """Returns a command with the refs after the change.

        `is_first`: whether the command is refused where both change the same feature; else it
        wins. `EditError`: an element is gone or cannot be found for certain, or was changed too.
        """
        if is_first:
            self._check(command)
        return with_created(command, self._followed)

    def _followed(self, ref: Ref) -> Ref:
        if refs.split(ref)[0] != self._file:
            return ref
        old = self._old.get(ref)
        new = self._same.get(old) if old is not None else None
        if new is None:
            what = old.label if old is not None else ref
            message = f"{what} of {self._file} is gone or has another name meanwhile"
            raise EditError(message, conflict=True)
        return self._refs[new]

    def _check(self, command: ElementCommand) -> None:
        old = self._old.get(command.element) if isinstance(command, Set | Remove | Rename) else None
        new = self._same.get(old) if old is not None else None
        if old is None or new is None:
            return
        if isinstance(command, Remove):
            if self._content(old) != self._content(new):
                message = f"{old.label} was changed meanwhile: look at it before it goes"
                raise EditError(message, conflict=True)
            return
        feature = command.feature if isinstance(command, Set) else _NAME
        if _value(old, feature) != _value(new, feature):
            now = ", ".join(map(str, new.values.get(feature, ()))) or "something else"
            message = f"{feature} of {old.label} was changed meanwhile, to {now}"
            raise EditError(message, conflict=True)

    # Identity

    def _pair(self, old: Iterable[ElementCopy], new: Iterable[ElementCopy]) -> None:
        pending = [(list(old), list(new))]
        while pending:
            before, after = pending.pop()
            # Names first; others are known by their contents, if these are unique.
            pairs = [*_unique(before, after, _named)]
            paired = set(chain.from_iterable(pairs))
            left, other = (
                [element for element in side if element not in paired] for side in (before, after)
            )
            pairs += _unique(left, other, self._content)
            for element, same in pairs:
                self._same[element] = same
                pending.append((_owned(element), _owned(same)))

    def _content(self, copy: ElementCopy) -> Hashable:
        """Returns the contents of a copy, without its position."""
        known = self._contents.get(copy)
        if known is None:
            names = sorted({*copy.values, *copy.references})
            values = tuple((name, _value(copy, name)) for name in names)
            owned = tuple(
                (name, tuple(map(self._content, child_list)))
                for name, child_list in sorted(copy.owned.items())
            )
            known = (copy.table.qualified_name, copy.feature, values, owned)
            self._contents[copy] = known
        return known


def _unique(
    before: Iterable[ElementCopy], after: Iterable[ElementCopy], mark: Callable[[ElementCopy], Any]
) -> Iterator[tuple[ElementCopy, ElementCopy]]:
    """Yields the pairs of copies whose mark is unique on both sides."""
    sides: list[dict[Hashable, list[ElementCopy]]] = []
    for copies in (before, after):
        copies_by_mark = defaultdict(list)
        for copy in copies:
            copies_by_mark[mark(copy)].append(copy)
        sides.append(copies_by_mark)
    old, new = sides
    for key, copies in old.items():
        others = new.get(key, ())
        # Of two with one mark, the same one is not known.
        if key is not None and len(copies) == len(others) == 1:
            yield copies[0], others[0]


def _named(copy: ElementCopy) -> Hashable:
    """Returns class, feature and name of a copy, None for a part without a name."""
    if not copy.name and copy.owner is not None:
        return None
    return copy.table.qualified_name, copy.feature, copy.name


def _owned(copy: ElementCopy) -> list[ElementCopy]:
    return [child for children in copy.owned.values() for child in children]


def _value(copy: ElementCopy, feature: str) -> Hashable:
    values = tuple(copy.values.get(feature, ()))
    targets = copy.references.get(feature, ())
    return values, tuple(target if isinstance(target, str) else _path(target) for target in targets)


def _path(copy: ElementCopy) -> Hashable:
    """Returns the path of a copy: names, and positions where there are none."""
    steps: list[Hashable] = []
    ancestor: ElementCopy | None = copy
    while ancestor is not None:
        siblings = (
            ancestor.owner.owned.get(ancestor.feature, []) if ancestor.owner is not None else []
        )
        steps.append(
            (
                ancestor.feature,
                ancestor.name or siblings.index(ancestor) if siblings else ancestor.name,
            )
        )
        ancestor = ancestor.owner
    return copy.file, tuple(steps)
