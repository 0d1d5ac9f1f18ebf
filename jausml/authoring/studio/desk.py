"""What all answers work with: the project, what was found about it, and who is told."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.records import Freshness
from jausml.authoring.studio import shown
from jausml.authoring.studio.answers.trying import Trials
from jausml.authoring.studio.audience import Audience
from jausml.authoring.studio.checking import Verdict, Verdicts
from jausml.authoring.studio.drawing import Drawings
from jausml.authoring.studio.faults import Faults
from jausml.authoring.studio.keeping import KeptEdits
from jausml.language.model.refs import file_of
from jausml.live.peers.network import (
    DEFAULT_GROUP,
    DEFAULT_INTERFACE,
    DEFAULT_PORT,
    Network,
    make_network,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.editing.project import Project
    from jausml.authoring.editing.records import Change, Entry

_MOST_SHOWN = 8


class LookedAt:
    """The files that someone looks at: those that were asked for last."""

    def __init__(self) -> None:
        self._files: OrderedDict[str, None] = OrderedDict()
        self._lock = threading.Lock()

    def look(self, file: str) -> None:
        """Remembers that someone looks at a file."""
        with self._lock:
            self._files[file] = None
            self._files.move_to_end(file)
            while len(self._files) > _MOST_SHOWN:
                self._files.popitem(last=False)

    @property
    def files(self) -> tuple[str, ...]:
        """The files, the latest first."""
        with self._lock:
            return tuple(reversed(self._files))


def usual_network() -> Network:
    """Returns the network of this computer alone."""
    return make_network(None, DEFAULT_INTERFACE, DEFAULT_PORT, DEFAULT_GROUP, ())


@dataclass
class Desk:
    """What answers work with.

    Attributes:
        out: Where `generate` writes when nobody says otherwise, empty for its default.
    """

    project: Project
    out: str = ""
    network: Network = field(default_factory=usual_network)
    audience: Audience = field(default_factory=Audience)
    looked_at: LookedAt = field(default_factory=LookedAt)
    drawings: Drawings = field(default_factory=Drawings)
    trials: Trials = field(default_factory=Trials)
    kept: KeptEdits = field(default_factory=KeptEdits)
    faults: Faults = field(default_factory=Faults)

    def __post_init__(self) -> None:
        self.verdicts = Verdicts(self.project)
        self.told_verdicts: dict[str, tuple[Verdict, dict[str, Any]]] = {}
        """The latest verdict of each file as pages know it."""
        self.pictures: dict[tuple[str, str], dict[str, Any]] = {}
        """The last picture of each view, by file and view."""
        self.followers: list[Callable[[], None]] = []
        """Are called when the project has changed."""

    def freshness(self, verdict: Verdict) -> Freshness:
        """Returns what a verdict is worth: in conflict also when an edit of a file is kept."""
        if not verdict.freshness.is_current:
            return verdict.freshness
        model, root = verdict.result.model, self.project.root
        kept = self.kept.concerning(frozenset(file_of(each, root) for each in model.documents))
        if not kept:
            return verdict.freshness
        why = (
            f"\u201c{kept[0].label}\u201d was not done and is kept: do it again or discard it first"
        )
        return Freshness("conflict", verdict.revision, why)

    def keep(self, commands: Sequence[Command], label: str, base: int, why: str) -> bool:
        """Keeps an edit that met a change beneath it, and tells of it; tells whether it could."""
        is_kept = self.kept.keep(commands, label, base, why)
        self.tell_kept()
        return is_kept

    def tell_kept(self) -> None:
        """Tells pages which edits are kept."""
        self.audience.tell("kept", {"edits": [each.told for each in self.kept.all]})

    def refresh(self, files: Iterable[str] = ()) -> None:
        """Takes over what other programs did to files, and tells of it.

        Args:
            files: Files that may have changed, relative to the root; without any, all.
        """
        self.tell_outside(self.project.refresh(files))

    def tell_outside(self, found: Sequence[Change]) -> None:
        """Tells of changes by other programs."""
        for each in found:
            told = "conflict" if each.is_conflict else "outside"
            self.audience.tell(told, {"file": each.file, "diff": each.diff})
        if found:
            log = reversed(self.project.log)
            self.changed(next((each for each in log if each.is_outside), None), by="outside")

    def changed(self, entry: Entry | None, *, by: str = "edit") -> None:
        """Tells pages and followers that the project has changed.

        Args:
            entry: What was done; one without changes is not told.
            by: Who did it: `edit` or `outside`.
        """
        if entry is not None and not entry.changes:
            return
        told = {
            "revision": self.project.revision,
            "files": shown.files(self.project),
            "entry": shown.entry(entry),
            "by": by,
        }
        self.audience.tell("changed", told)
        for each in self.followers:
            each()
