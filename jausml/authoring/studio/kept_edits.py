"""Edits that met a change beneath them: kept until somebody does them again or discards them."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import Add, Create, Place
from jausml.authoring.studio.json_values import as_json
from jausml.language.model import refs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import Command

_MOST = 64


@dataclass(frozen=True)
class KeptEdit:
    """An edit that was not done."""

    number: int
    label: str
    commands: tuple[Command, ...]
    base: int
    why: str

    @property
    def files(self) -> frozenset[str]:
        """The files that it would change."""
        return frozenset(filter(None, map(_file, self.commands)))

    def as_json(self) -> dict[str, Any]:
        """What pages are told of it."""
        return {
            "number": self.number,
            "label": self.label,
            "commands": as_json(self.commands),
            "why": self.why,
            "files": sorted(self.files),
        }


class KeptEdits:
    """The edits that are kept, the oldest first; any thread may ask."""

    def __init__(self) -> None:
        self._edits: dict[int, KeptEdit] = {}
        self._count = 0
        self._lock = threading.Lock()

    @property
    def all(self) -> tuple[KeptEdit, ...]:
        """All of them."""
        with self._lock:
            return tuple(self._edits.values())

    def keep(self, commands: Sequence[Command], label: str, base: int, why: str) -> bool:
        """Keeps an edit; tells whether there was room for it."""
        with self._lock:
            if len(self._edits) >= _MOST:
                return False
            self._count += 1
            kept = KeptEdit(self._count, label, tuple(commands), base, why)
            self._edits[kept.number] = kept
            return True

    def find(self, number: int) -> KeptEdit | None:
        """Returns an edit, None when it is kept no more."""
        with self._lock:
            return self._edits.get(number)

    def discard(self, number: int) -> None:
        """Forgets an edit."""
        with self._lock:
            self._edits.pop(number, None)

    def concerning(self, files: frozenset[str]) -> tuple[KeptEdit, ...]:
        """Returns those that would change one of some files."""
        return tuple(each for each in self.all if not each.files.isdisjoint(files))


def _file(command: Command) -> str:
    """Returns the file that a command changes first."""
    if isinstance(command, Create | Place):
        return command.file
    return refs.split(command.owner if isinstance(command, Add) else command.element)[0]
