"""Records of a project: its files, previews of changes, and the log of changes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from time import monotonic
from typing import Literal

from jausml.authoring.editing.splices import Splice, difference
from jausml.language.model.diagnostics import Diagnostic
from jausml.language.model.refs import Ref


@dataclass(frozen=True, slots=True)
class FileInfo:
    """A model file of a project.

    `path`: the file, relative to the root with forward slashes. `is_stale`: whether it cannot be
    read as it is, so that its model is an earlier one.
    """

    path: str
    notation: Literal["xmi", "text"]
    revision: int
    is_stale: bool = False

    @property
    def is_dirty(self) -> bool:
        """Whether it is text that cannot be parsed as it is."""
        return self.is_stale and self.notation == "text"


@dataclass(frozen=True, slots=True)
class FileChange:
    """A change of one file: splices, each of the result of the one before.

    `before`, `after`: digests of the file before and after, empty where it does not exist.
    """

    file: str
    splices: tuple[Splice, ...]
    before: str
    after: str

    @classmethod
    def between(cls, file: str, before: Stored | None, after: Stored | None) -> FileChange:
        """Returns the change from one state of a file to another; None for no file."""
        splice = difference(data_of(before) or b"", data_of(after) or b"")
        digests = (held.digest if held is not None else "" for held in (before, after))
        return cls(file, (splice,), *digests)

    def inverted(self) -> FileChange:
        """Returns the opposite change."""
        splices = tuple(splice.inverted() for splice in reversed(self.splices))
        return FileChange(self.file, splices, self.after, self.before)

    def applied(self, data: bytes) -> bytes:
        """Returns the file after the change, for its bytes before."""
        for splice in self.splices:
            data = splice.applied(data)
        return data


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry of the log: changes that are made and undone together.

    `number`: counted from 1, never used again. `created`: refs of new elements, valid in the
    revision after it. `formatted`: files that it has formatted first.
    """

    number: int
    label: str
    changes: tuple[FileChange, ...]
    created: tuple[Ref, ...] = ()
    is_outside: bool = False
    formatted: tuple[str, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """The files that it changes."""
        return tuple(change.file for change in self.changes)


@dataclass(frozen=True, slots=True)
class Referrer:
    """An element that refers to another one: its ref, its label, and the feature."""

    element: Ref
    label: str
    feature: str


@dataclass(frozen=True, slots=True)
class Preview:
    """The effect of commands, before they are carried out.

    `referrers`: elements that refer to removed ones, and would lose that reference or be removed.
    `diff`: the differences of the files, as `diff -u` writes them.
    """

    changes: tuple[FileChange, ...]
    created: tuple[Ref, ...] = ()
    referrers: tuple[Referrer, ...] = ()
    diff: str = ""


@dataclass(frozen=True, slots=True)
class Change:
    """A change of a file by another program.

    `is_conflict`: whether it has overwritten the last edit unseen.
    """

    file: str
    diff: str = ""
    is_conflict: bool = False


@dataclass(frozen=True, slots=True)
class Freshness:
    """How current an answer about a model is.

    Attributes:
        state: `current`; `stale` for an answer of an earlier revision; `unreadable` where a file
            cannot be read as it is; `conflict` where two changes of it are not merged.
        since: The revision of its files; None where they never could be read.
        why: The reason why it is not current, for people; empty when it is.
    """

    state: Literal["current", "stale", "unreadable", "conflict"]
    since: int | None
    why: str = ""
    faults: tuple[Diagnostic, ...] = ()

    @property
    def is_current(self) -> bool:
        """Whether verdicts may be given, and code be generated."""
        return self.state == "current"


@dataclass(slots=True)
class Stored:
    """A file as the project knows it.

    `good`: the bytes of its model: `data`, or the last ones that could be parsed. `is_printed`:
    whether an edit has laid it out.
    """

    file: str
    data: bytes
    digest: str
    revision: int
    good: bytes = field(default=b"")
    good_since: int = 0
    is_printed: bool = False

    @property
    def is_stale(self) -> bool:
        """Whether its model is that of earlier bytes."""
        return self.good is not self.data


def data_of(held: Stored | None) -> bytes | None:
    """Returns the bytes of a file, None for no file."""
    return held.data if held is not None else None


class Log:
    """Entries in order, of which the first ones are done and the others undone."""

    def __init__(self) -> None:
        self._entries: list[Entry] = []
        self._at = 0
        self._count = 0
        self._typed = (0, 0.0)
        """Number and time of the last typed entry."""

    @property
    def done(self) -> tuple[Entry, ...]:
        """The entries that were done and not undone, in order."""
        return tuple(self._entries[: self._at])

    @property
    def undone(self) -> tuple[Entry, ...]:
        """The entries that can be done again, the next first."""
        return tuple(self._entries[self._at :])

    @property
    def last(self) -> Entry | None:
        """The entry that was done last, None without one."""
        return self._entries[self._at - 1] if self._at else None

    @property
    def next(self) -> Entry | None:
        """The entry that was undone last, None without one."""
        return self._entries[self._at] if self._at < len(self._entries) else None

    def add(
        self,
        label: str,
        changes: tuple[FileChange, ...],
        created: tuple[Ref, ...] = (),
        *,
        is_outside: bool = False,
        formatted: tuple[str, ...] = (),
    ) -> Entry:
        """Adds an entry; entries that were undone before can no longer be done again."""
        self._count += 1
        if formatted:
            label = f"{label}, and format {' and '.join(formatted)}"
        entry = Entry(self._count, label, changes, created, is_outside, formatted)
        self._entries[self._at :] = [entry]
        self._at += 1
        return entry

    def add_typing(self, label: str, changes: tuple[FileChange, ...], pause: float) -> Entry:
        """Adds typing in a file: to the last entry, unless there was a pause or another change."""
        [new], last, (number, at), now = changes, self.last, self._typed, monotonic()
        is_fluent = self.next is None and now - at <= pause
        if last is not None and (last.number, last.files) == (number, (new.file,)) and is_fluent:
            [old] = last.changes
            change = replace(new, splices=(*old.splices, *new.splices), before=old.before)
            entry = self._entries[self._at - 1] = replace(last, changes=(change,))
        else:
            entry = self.add(label, changes)
        self._typed = entry.number, now
        return entry

    def step(self, by: int) -> None:
        """Notes that the next entry was done again, or for -1, that the last one was undone."""
        self._at += by


def takes_back(entry: Entry | None, known: Stored | None, new: bytes | None) -> bool:
    """Tells whether a file has the lines again that an edit replaced, and no new ones of it."""
    if entry is None or known is None or new is None or entry.is_outside:
        return False
    for change in entry.changes:
        if change.file == known.file and change.after == known.digest:
            before = change.inverted().applied(known.data)
            old, own, now = (set(version.splitlines()) for version in (before, known.data, new))
            return old != own and old - own <= now and not (own - old) & now
    return False
