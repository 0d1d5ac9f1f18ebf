"""Context of request handlers: what all requests of a studio are about."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, Literal

from jausml.authoring.editing.commands import Add, Command, Create, Place
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.records import Change, Freshness
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.studio.checking import Verdict, Verdicts
from jausml.authoring.studio.drawing import Drawings
from jausml.authoring.studio.faults import Faults
from jausml.authoring.studio.recordings import Recordings
from jausml.authoring.studio.rpc import files_as_json, log_as_json
from jausml.authoring.studio.views.trying import Trials
from jausml.language.model import refs
from jausml.language.model.model import Model
from jausml.language.model.refs import file_of
from jausml.live.peers.network import (
    DEFAULT_GROUP,
    DEFAULT_INTERFACE,
    DEFAULT_PORT,
    Network,
    make_network,
)
from jausml.live.serving.subscribers import Subscribers

_MOST_KEPT = 64


@dataclass(frozen=True)
class KeptEdit:
    """An edit that was not done.

    Attributes:
        number: Its number among the kept ones, by which pages name it.
        base: The revision of the project that it was made for.
        why: Why it was not done.
    """

    number: int
    label: str
    commands: tuple[Command, ...]
    base: int
    why: str

    @property
    def files(self) -> frozenset[str]:
        """The files that it would change."""
        return frozenset(filter(None, map(_file, self.commands)))


def _file(command: Command) -> str:
    """Returns the file that a command changes first."""
    if isinstance(command, Create | Place):
        return command.file
    return refs.split(command.owner if isinstance(command, Add) else command.element)[0]


_MOST_VIEWED = 8


class ViewedFiles:
    """The files that someone looks at: those that were asked for last, the latest first."""

    def __init__(self) -> None:
        self.files: tuple[str, ...] = ()
        self._lock = threading.Lock()

    def add(self, file: str) -> None:
        """Remembers that someone looks at a file."""
        with self._lock:
            others = (other for other in self.files if other != file)
            self.files = (file, *others)[:_MOST_VIEWED]


# The network of this computer alone.
_USUAL = (DEFAULT_INTERFACE, DEFAULT_PORT, DEFAULT_GROUP, ())


@dataclass
class StudioContext:
    """The surroundings of request handlers.

    Attributes:
        out: Where `generate` writes when nobody says otherwise, empty for its default.
        network: The network on which live values are looked for.
        subscribers: The pages.
        given_recordings: Those that pages may open beside the files of the project.
        sent_verdicts: The latest verdict of each file as pages know it.
        pictures: The last picture of each view, by file and view.
        kept: Edits that were not done, the oldest first; what changes something takes its turn.
        followers: Are called when the project has changed.
    """

    project: Project
    out: str = ""
    network: Network = field(default_factory=partial(make_network, None, *_USUAL))
    subscribers: Subscribers = field(default_factory=Subscribers)
    viewed_files: ViewedFiles = field(default_factory=ViewedFiles)
    trials: Trials = field(default_factory=Trials)
    faults: Faults = field(default_factory=Faults)
    given_recordings: tuple[Path, ...] = ()

    def __post_init__(self) -> None:
        self.drawings = Drawings(self.project.root)
        self.recordings = Recordings(self.project.root, self.given_recordings)
        self.verdicts = Verdicts(self.project)
        self.sent_verdicts: dict[str, tuple[Verdict, dict[str, Any]]] = {}
        self.pictures: dict[tuple[str, str], dict[str, Any]] = {}
        self.kept: tuple[KeptEdit, ...] = ()
        self.followers: list[Callable[[], None]] = []
        self._numbers = count(1)

    def freshness(self, verdict: Verdict) -> Freshness:
        """Returns how current a verdict is: in conflict also when an edit of a file is kept."""
        if not verdict.freshness.is_current:
            return verdict.freshness
        model, root = verdict.result.model, self.project.root
        files = {file_of(document, root) for document in model.documents}
        kept = next((edit for edit in self.kept if not edit.files.isdisjoint(files)), None)
        if kept is None:
            return verdict.freshness
        why = f"\u201c{kept.label}\u201d was not done and is kept: do it again or discard it first"
        return Freshness("conflict", verdict.revision, why)

    def scope_of(self, file: str, model: Model | None = None) -> Scope:
        """Returns the model of a file as answers see it, with the rest of the project."""
        model = self.project.model(file).model if model is None else model
        return Scope(model, self.project.root, lambda: self.project.beside(file))

    def scope_of_library(self, element: str) -> Scope:
        """Returns the model of an element of the library, given by its ref."""
        return Scope(self.project.find(element)[1], self.project.root)

    def keep(self, commands: Sequence[Command], label: str, base: int, why: str) -> bool:
        """Keeps an edit that met a conflict; tells whether there was room for it."""
        if len(self.kept) >= _MOST_KEPT:
            return False
        edit = KeptEdit(next(self._numbers), label, tuple(commands), base, why)
        self._keep((*self.kept, edit))
        return True

    def discard(self, number: int) -> None:
        """Keeps an edit no more."""
        self._keep(edit for edit in self.kept if edit.number != number)

    def _keep(self, edits: Iterable[KeptEdit]) -> None:
        self.kept = tuple(edits)
        self.subscribers.notify("kept", {"edits": self.kept})

    def refresh(self, files: Iterable[str] = ()) -> None:
        """Reads changes of other programs, and reports them.

        Args:
            files: Files that may have changed, relative to the root; without any, all.
        """
        self.notify_outside(self.project.refresh(files))

    def notify_outside(self, changes: Sequence[Change]) -> None:
        """Tells of changes by other programs."""
        for change in changes:
            event = "conflict" if change.is_conflict else "outside"
            is_gone = all(file.path != change.file for file in self.project.files)
            parameters = {"file": change.file, "diff": change.diff, "gone": is_gone}
            self.subscribers.notify(event, parameters)
        if changes:
            self.changed(by="outside")

    def changed(self, *, by: Literal["edit", "outside"] = "edit") -> None:
        """Reports to pages and followers that the project has changed, and by whom."""
        state = {
            "revision": self.project.revision,
            "files": files_as_json(self.project),
            "by": by,
            **log_as_json(self.project),
        }
        self.subscribers.notify("changed", state)
        for follower in self.followers:
            follower()
