"""What all answers work with: the project, what was found about it, and who is told."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jausml.live.peers.network import (
    DEFAULT_GROUP,
    DEFAULT_INTERFACE,
    DEFAULT_PORT,
    Network,
    make_network,
)
from jausml.studio import shown
from jausml.studio.answers.trying import Trials
from jausml.studio.audience import Audience
from jausml.studio.checking import Verdict, Verdicts
from jausml.studio.drawing import Drawings

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.editing.project import Project
    from jausml.editing.records import Entry

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
        project: The folder that was opened, and its models.
        out: Where `generate` writes when nobody says otherwise, empty for its default.
        network: Where the JAUS components of a running system are.
        audience: The pages.
        looked_at: The files that someone looks at.
        drawings: Where the boxes of views stand.
        trials: Translations that pages try.
    """

    project: Project
    out: str = ""
    network: Network = field(default_factory=usual_network)
    audience: Audience = field(default_factory=Audience)
    looked_at: LookedAt = field(default_factory=LookedAt)
    drawings: Drawings = field(default_factory=Drawings)
    trials: Trials = field(default_factory=Trials)

    def __post_init__(self) -> None:
        self.verdicts = Verdicts(self.project)
        self.told_verdicts: dict[str, tuple[Verdict, dict[str, Any]]] = {}
        """The latest verdict of each file as pages know it."""
        self.followers: list[Callable[[], None]] = []
        """Are called when the project has changed."""

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
