"""Where boxes and lines of views stood, kept from one session to the next beside the models.

The folder says to Git that it is no part of the project: what users place by hand is in the layout
file, which is.
"""

from __future__ import annotations

import json
import logging
import threading
from collections.abc import Mapping
from functools import partial
from pathlib import Path, PurePosixPath

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import Disk
from jausml.live.serving.rpc import TypedError, typed
from jausml.views.diagrams.writers.values import Standing

_LOG = logging.getLogger(__name__)

FOLDER = ".jausml"
_IGNORE, _ALL = ".gitignore", b"*\n"
_LARGEST = 16 * 1024 * 1024
_FARTHEST = 1_000_000


class Memory:
    """The remembered places in the views of all files; any thread may ask."""

    def __init__(self, root: Path) -> None:
        self._disk = Disk(root)
        self._lock = threading.Lock()
        self._views: dict[str, dict[str, object]] = {}

    def standing(self, file: str, view: str) -> Standing:
        """Returns where the parts of a view stood; nothing where that is not known."""
        with self._lock:
            if file not in self._views:
                self._views[file] = self._read(file)
            known = self._views[file].get(view, {})
        try:
            return typed(Standing, known)()
        except TypedError:
            return Standing()

    def keep(self, file: str, standings: Mapping[str, Standing]) -> None:
        """Keeps where the parts of views of a file stand; those of other views stay as they are."""
        with self._lock:
            before = self._views.get(file, {})
            now = before | json.loads(json.dumps(standings, default=vars))
            if now == before:
                return
            self._views[file] = now
            text = json.dumps({"views": now}, ensure_ascii=False, separators=(",", ":"))
            try:
                self._store(_place(file, _IGNORE), _ALL)
                self._store(_place(file), text.encode("utf-8", "backslashreplace"))
            except (EditError, OSError):
                _LOG.debug("places of %s are not kept", file, exc_info=True)

    def _store(self, path: str, data: bytes) -> None:
        # It is looked at first: it may lead out of the folder.
        if self._disk.read(path) != data:
            self._disk.store(path, data)

    def _read(self, file: str) -> dict[str, object]:
        data = self._disk.readable(_place(file)) or b""
        try:
            read = partial(json.loads, parse_int=_near, parse_float=_near, parse_constant=_near)
            views = read(data)["views"] if len(data) <= _LARGEST else {}
        except (LookupError, RecursionError, TypeError, ValueError):
            return {}
        return views if isinstance(views, dict) else {}


def _place(file: str, name: str = "") -> str:
    path = PurePosixPath(file)
    return str(path.parent / FOLDER / (name or f"{path.name}.views.json"))


def _near(text: str) -> float:
    """Returns a number of a file, which is a place on a drawing."""
    value = float(text)
    if not abs(value) <= _FARTHEST:
        raise ValueError(f"{text} is no place")
    return value
