"""Projects: the model files of a folder, with a log of their changes."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from jausml.authoring.editing import records
from jausml.authoring.editing.clips import Clip, clip_text, read_clip
from jausml.authoring.editing.commands import Add, Command, EditError, LayoutKey, Set
from jausml.authoring.editing.describing import pasted
from jausml.authoring.editing.drafts import Draft, check_new_file
from jausml.authoring.editing.executing import concerned, execute, referrers
from jausml.authoring.editing.layout import SUFFIXES, is_layout, layout_file, read_layout
from jausml.authoring.editing.reading import Disk, Reader, encoded, is_library, is_text, stored
from jausml.authoring.editing.rebasing import OutsideChange, Rebasing
from jausml.authoring.editing.splices import unified_diff
from jausml.authoring.editing.working_copy import WorkingCopy
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import refs
from jausml.language.model.files import read_input
from jausml.language.model.model import Model
from jausml.language.model.project import find_project_root, is_model_file, model_files
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.model.refs import Ref
from jausml.language.text.notation import NOTATIONS

_ATTEMPTS = 3  # times that commands are planned again when other programs change files meanwhile


_OUTSIDE = "JML209"  # the rule by which a file outside of the root is not read


def _folder_of_all(path: Path) -> Path:
    """Returns the smallest folder with a model file and all files that it may refer to."""
    root = find_project_root([path])
    documents = read_models([path], project_root=root, notations=NOTATIONS).model.documents
    real = (Path(os.path.realpath(document.path)) for document in documents)
    own = [file.parent for file in real if file.is_relative_to(root)]
    return Path(os.path.commonpath([path.parent, *own]))


class ChangedBeneathError(EditError):
    """Another program has changed a file: that was read, and nothing was written."""


class Project:
    """The model files below one folder: the opened one, or that of a file and its references.

    Every change is written at once and logged. One that cannot be made raises `EditError`, and
    nothing is written. All methods may be called from any thread. `opened` is the opened model
    file, relative to the root; empty for a folder.
    """

    def __init__(self, opened: str | os.PathLike[str]) -> None:
        path = Path(os.path.realpath(opened))
        self._lock = threading.RLock()
        self._revision = 0
        self._open(path, path if path.is_dir() else path.parent)
        if self.opened and any(
            finding.rule == _OUTSIDE for finding in self.model(path.name).diagnostics
        ):
            self._open(path, _folder_of_all(path))
        self._log = records.Log()
        self._rebasing = Rebasing()
        self.typing_pause = 2.0
        """Seconds without typing after which the next one is another entry of the log."""
        self._working_copy: WorkingCopy | None = None
        self._unreported: list[records.Change] = []

    def _open(self, path: Path, root: Path) -> None:
        self.root = root
        self.opened = "" if path == root else path.relative_to(root).as_posix()
        self._reader = Reader(root)
        self._disk = Disk(root)
        self._files: dict[str, records.Stored] = {}
        named = [self.opened] if self.opened else []
        for file in dict.fromkeys([*model_files(self.root, SUFFIXES), *named]):
            data = self._disk.readable(file)
            if data is not None:
                self._files[file] = stored(file, data, 0)
        if self.opened and self.opened not in self._files:
            read_input(self.root / self.opened)

    @property
    def files(self) -> tuple[records.FileInfo, ...]:
        """The model files, in order of their names."""
        with self._lock:
            return tuple(
                records.FileInfo(
                    name, "text" if is_text(name) else "xmi", entry.revision, entry.is_stale
                )
                for name, entry in sorted(self._files.items())
                if not is_layout(name)
            )

    @property
    def revision(self) -> int:
        """The number of the state, one more after each change."""
        return self._revision

    @property
    def log(self) -> tuple[records.Entry, ...]:
        """The entries that were done and not undone, in order."""
        with self._lock:
            return self._log.done

    @property
    def undone(self) -> tuple[records.Entry, ...]:
        """The entries that can be done again, the next first."""
        with self._lock:
            return self._log.undone

    def model(self, file: str) -> ReadResult:
        """Returns the model of a file and of all files that it refers to.

        It is of the last revision in which the file could be parsed. Once the file has changed,
        another one is returned.
        """
        with self._lock:
            self._known(file)
            return self._reader.read(file, self._files)

    def read(self, file: str) -> tuple[ReadResult, records.Freshness]:
        """Returns the model of a file as `model` does, and how current it is."""
        with self._lock:
            return self.model(file), self._reader.freshness(file, self._files, self._revision)

    def beside(self, file: str) -> Model:
        """Returns the model of the files to which the model of a file does not refer."""
        with self._lock:
            return self._reader.beside(file, self._files)

    def text(self, file: str) -> bytes:
        """Returns the bytes of a file."""
        with self._lock:
            return self._known(file).data

    def ref(self, obj: EObject | None, model: Model) -> Ref:
        """Returns the ref of an element of a model of this project; empty for None."""
        return refs.ref_of(obj, model, self.root)

    def find(self, ref: Ref) -> tuple[EObject, Model]:
        """Returns the element of a ref, and the model of its file.

        Elements of the library are searched in the models of all files.
        """
        file, _ = refs.split(ref)
        with self._lock:
            models = [model_file for model_file in self._files if not is_layout(model_file)]
            for model_file in models if is_library(file) else [self._known(file).file]:
                model = self.model(model_file).model
                element = refs.find(ref, model, self.root)
                if element is not None:
                    return element, model
        raise EditError(f"there is no element {ref}", conflict=True)

    def preview(self, commands: Sequence[Command], base: int | None = None) -> records.Preview:
        """Returns the effect of commands with refs of a revision; nothing is written."""
        with self._lock:
            commands = self._rebased(commands, base)
            draft = self._draft()
            outcome = execute(commands, draft)
            changes = draft.changes()
            new = {change.file: draft.files.get(change.file) for change in changes}
            diff = "".join(
                unified_diff(file, self._data(file) or b"", new_file.data if new_file else b"")
                for file, new_file in new.items()
            )
            referrers = concerned(commands, self._draft())
            return records.Preview(changes, outcome.created, referrers, diff)

    def do(
        self,
        commands: Sequence[Command],
        label: str,
        base: int | None = None,
        *,
        is_first: bool = True,
    ) -> records.Entry:
        """Carries out commands, all or none, writes the files, and logs the change.

        Where another program has just changed a file, they are planned again for its new state.
        Their refs are those of the revision `base`, and are followed through later changes. Where
        others have changed the same feature, commands with `is_first` are refused, others win. An
        entry without changes is not in the log.
        """
        with self._lock:
            base = self._revision if base is None else base
            with suppress(ChangedBeneathError):
                return self._done(self._rebased(commands, base, is_first=is_first), label)
            # With the lock of the folder, programs that write often cannot prevent it.
            with self._disk.alone():
                for _ in range(_ATTEMPTS):
                    with suppress(ChangedBeneathError):
                        return self._done(self._rebased(commands, base, is_first=is_first), label)
                return self._done(self._rebased(commands, base, is_first=is_first), label)

    def _rebased(
        self, commands: Sequence[Command], base: int | None, *, is_first: bool = True
    ) -> Sequence[Command]:
        now = self._revision
        if base is None or base >= now:
            return commands
        rebased = self._rebasing.rebased
        return [rebased(command, base, now, is_first=is_first) for command in commands]

    def _done(self, commands: Sequence[Command], label: str) -> records.Entry:
        draft = self._draft()
        # After a failure, the copy has a part of the changes.
        working_copy, self._working_copy = self._working_copy, None
        outcome = execute(commands, draft, working_copy)
        changes = draft.changes()
        if not changes:
            # The files must be unchanged too, not only their known states.
            self._check_unchanged(outcome.working_copy.models)
            self._working_copy = outcome.working_copy
            return records.Entry(0, label, ())
        self._write({change.file: draft.files.get(change.file) for change in changes})
        # Only now, as the copy has to agree with the written files.
        self._working_copy = outcome.working_copy
        formatted = tuple(dict.fromkeys(outcome.formatted))
        entry = self._log.add(label, changes, outcome.created, formatted=formatted)
        self._rebasing.note(self._revision, entry, outcome.shifts)
        return entry

    def write_text(self, file: str, text: str, base: int) -> records.Entry:
        """Writes a typed text, also one that cannot be parsed: then its last model stays."""
        with self._lock:
            known = self._known(file)
            if not is_text(file):
                raise EditError(f"{file} is no text: edit it by its diagram and its forms")
            if known.revision > base:
                message = f"{file} has changed since: look at it again, and repeat what you typed"
                raise EditError(message, conflict=True)
            changes = self._put(file, encoded(text, known.data))
            if not changes:
                return records.Entry(0, f"Type in {file}", ())
            return self._log.add_typing(f"Type in {file}", changes, self.typing_pause)

    def add_file(self, file: str, data: bytes, label: str) -> records.Entry:
        """Makes a model file of bytes (`EditError`: it exists)."""
        with self._lock:
            check_new_file(file, self._draft())
            return self._log.add(label, self._put(file, data))

    def _put(self, file: str, data: bytes) -> tuple[records.FileChange, ...]:
        """Writes bytes to a file that are not of commands."""
        draft = self._draft()
        draft.put(file, data)
        changes = draft.changes()
        if changes:
            before = dict(self._files)
            self._write({file: draft.files[file]})
            self._note_outside(file, before)
        return changes

    def undo(self) -> records.Entry | None:
        """Undoes the last entry, if there is one (`EditError`: its files have changed since)."""
        with self._lock:
            entry = self._log.last
            if entry is not None:
                self._replay(entry, [change.inverted() for change in entry.changes], back=True)
                self._log.step(-1)
            return entry

    def redo(self) -> records.Entry | None:
        """Redoes the last undone entry, if there is one (`EditError`: its files have changed)."""
        with self._lock:
            entry = self._log.next
            if entry is not None:
                self._replay(entry, entry.changes, back=False)
                self._log.step(1)
            return entry

    def refresh(self, paths: Iterable[str] = ()) -> tuple[records.Change, ...]:
        """Reads changes of other programs, in all files or in some, relative to the root.

        Each change becomes an entry of the log; those that edits have read are returned too.
        """
        with self._lock:
            wanted = sorted(set(paths) or {*self._files, *model_files(self.root, SUFFIXES)})
            known = (
                name
                for name in wanted
                if name in self._files or is_model_file(name, self.root, SUFFIXES)
            )
            return (*self.unreported(), *filter(None, map(self._refreshed, list(known))))

    def unreported(self) -> tuple[records.Change, ...]:
        """Returns the changes of other programs that edits have read, each once."""
        with self._lock:
            met, self._unreported = self._unreported, []
            return tuple(met)

    def copy(self, elements: Sequence[Ref]) -> str:
        """Returns elements of one model as text, for any clipboard."""
        with self._lock:
            if not elements:
                raise EditError("nothing was chosen that could be copied")
            model = self._draft().locate(elements[0])[1]
            objects = [refs.find(element, model, self.root) for element in elements]
            missing = [
                reference for reference, obj in zip(elements, objects, strict=True) if obj is None
            ]
            if missing:
                raise EditError(f"{missing[0]} is of another model: copy it by itself")
            return clip_text(
                [element for element in objects if element is not None], model, self.root
            )

    def clip(self, text: str, owner: Ref) -> Clip:
        """Returns the elements of a text, as they can be pasted into an owner."""
        with self._lock:
            draft = self._draft()
            held = {file: draft.files[file].data for file in draft.models}
            return read_clip(text, self.root, held, draft.documents(draft.editable(owner)))

    def paste(self, commands: Sequence[Add | Set], owner: Ref, label: str) -> records.Entry:
        """Adds the elements of a clip, under names that are free."""
        with self._lock:
            obj, model = self._draft().element(owner)
            return self.do(pasted(commands, obj, model, self.ref), label)

    def referrers(self, ref: Ref) -> tuple[records.Referrer, ...]:
        """Returns the elements that refer to an element or to one of its parts, in all files."""
        with self._lock:
            return referrers(ref, self._draft())

    def positions(self, file: str, view: str) -> Mapping[LayoutKey, tuple[int, int]]:
        """Returns the upper left corners of boxes that were placed by hand in a view, by key."""
        with self._lock:
            held = self._files.get(layout_file(file))
            return read_layout(held.data).get(view, {}) if held is not None else {}

    def _known(self, file: str) -> records.Stored:
        stored_file = self._files.get(file)
        if stored_file is None or is_layout(file):
            raise EditError(f"{file} is no model file of the opened folder")
        return stored_file

    def _draft(self) -> Draft:
        return Draft(self.root, self._files, self._reader, self._revision + 1)

    def _write(self, changed: Mapping[str, records.Stored | None]) -> None:
        """Writes files, all or none, if they still have their known states."""
        # No other program may write between the check and the storing.
        with self._disk.alone():
            self._check_unchanged(changed)
            self._store(changed)
        self._revision += 1
        for file, new in changed.items():
            if new is None:
                self._files.pop(file, None)
            else:
                self._files[file] = new

    def _store(self, changed: Mapping[str, records.Stored | None]) -> None:
        written: list[str] = []
        try:
            for file, new in changed.items():
                self._disk.store(file, new.data if new is not None else None)
                written.append(file)
        except OSError as error:
            # All or none: the written files get their former bytes.
            for file in written:
                self._disk.store(file, self._data(file))
            raise EditError(f"{error.filename} cannot be written: {error.strerror}") from error

    def _check_unchanged(self, files: Iterable[str]) -> None:
        """Raises ChangedBeneathError for a file that another program has just saved."""
        for file in files:
            if self._disk.read(file) != self._data(file):
                change = self._refreshed(file)
                if change is not None:
                    self._unreported.append(change)
                message = f"{file} was just changed by another program: look at it, and repeat"
                raise ChangedBeneathError(message, conflict=True)

    def _replay(
        self, entry: records.Entry, changes: Sequence[records.FileChange], *, back: bool
    ) -> None:
        new: dict[str, records.Stored | None] = {}
        for change in changes:
            known = self._files.get(change.file)
            if (known.digest if known is not None else "") != change.before:
                message = f"{change.file} has changed since: its last edit cannot be taken back"
                raise EditError(message, conflict=True)
            data = change.applied(records.data_of(known) or b"")
            state = stored(change.file, data, self._revision + 1, known)
            new[change.file] = state if change.after else None
        files = dict(self._files)
        self._write(new)
        is_known = self._rebasing.note_again(self._revision, entry, back=back)
        for file in () if is_known else entry.files:
            # Without known commands, it is treated as a change by another program.
            self._note_outside(file, files)

    def _refreshed(self, file: str) -> records.Change | None:
        known = self._files.get(file)
        try:
            content = self._disk.read(file)
        except EditError:
            return None  # it is left alone until it can be read again
        if content == self._data(file):
            return None
        old, new = self._data(file) or b"", content or b""
        is_conflict = records.takes_back(self._log.last, known, content)
        self._revision += 1
        files = dict(self._files)
        if content is None:
            del self._files[file]
        else:
            self._files[file] = stored(file, content, self._revision, known)
        change = records.FileChange.between(file, known, self._files.get(file))
        self._note_outside(file, files)
        self._log.add(f"{file} was changed by another program", (change,), is_outside=True)
        return records.Change(file, unified_diff(file, old, new), is_conflict)

    def _note_outside(self, file: str, before: Mapping[str, records.Stored]) -> None:
        """Keeps a change without commands, and how to compare its states."""
        after = dict(self._files)

        def understood() -> OutsideChange:
            if file not in before or file not in after:
                raise EditError(f"{file} was deleted, or came again, meanwhile", conflict=True)
            models = (self._reader.read(file, snapshot).model for snapshot in (before, after))
            return OutsideChange(
                file, *(WorkingCopy.of({file: model}, self.root) for model in models)
            )

        self._rebasing.note_outside(self._revision, file, understood)

    def _data(self, file: str) -> bytes | None:
        return records.data_of(self._files.get(file))
