"""Who has the project open: pages of this studio, and of other studios of the same user.

A studio notes its pages in a file beside those of the others, and holds a lock on it: what is not
locked is of a studio that has ended, however it did. Where there are no such locks, or no such
folder, there are no others to be told of.
"""

from __future__ import annotations

import asyncio
import hashlib
import json
import os
import secrets
import sys
import threading
from contextlib import suppress
from dataclasses import asdict, dataclass
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from watchfiles import awatch

from jausml.language.model.inputs import open_input

if sys.platform != "win32":
    import fcntl

if TYPE_CHECKING:
    from collections.abc import Callable

LONGEST = 40
"""Characters of a name that somebody gives a page."""

_MOST_READ = 64 * 1024
_LOOK_AGAIN_MS = 3000
"""Milliseconds after which is looked again: a studio that is killed says nothing."""


@dataclass(frozen=True)
class Look:
    """Where somebody looks: at a view of a file, and there at an element, empty for none.

    `name`: what the person typed; empty where nobody did.
    """

    name: str = ""
    file: str = ""
    view: str = ""
    element: str = ""


class Presence:
    """The pages that are open; any thread may ask and tell."""

    def __init__(self, root: Path, told: Callable[[dict[str, Any]], None]) -> None:
        """Begins with nobody (`told`: takes what pages are to be told)."""
        self._told = told
        self._pages: dict[int, Look] = {}
        self._elsewhere: dict[str, list[dict[str, Any]]] = {}
        self._numbers = count(1)
        self._lock = threading.Lock()
        self._notes = _Notes(root)

    def enter(self) -> int:
        """Returns the number of a page that has come."""
        with self._lock:
            number = next(self._numbers)
            self._pages[number] = Look()
        self._changed()
        return number

    def look(self, number: int, look: Look) -> None:
        """Notes where a page looks."""
        with self._lock:
            if self._pages.get(number) == look:
                return
            self._pages[number] = look
        self._changed()

    def leave(self, number: int) -> None:
        """Notes that a page has gone."""
        with self._lock:
            self._pages.pop(number, None)
        self._changed()

    def all(self) -> dict[str, Any]:
        """Returns who is there, each with an id that no other one has."""
        with self._lock:
            here = [{"id": str(n), "here": True, **asdict(e)} for n, e in self._pages.items()]
            there = [
                {**each, "id": f"{name}/{each['id']}", "here": False}
                for name, pages in self._elsewhere.items()
                for each in pages
            ]
        return {"pages": [*here, *there]}

    async def watch(self, end: asyncio.Event) -> None:
        """Follows what other studios note, until the end."""
        folder = await asyncio.to_thread(self._begin)
        if folder is None:
            return
        try:
            self._look_elsewhere()
            async for _ in awatch(
                folder, stop_event=end, rust_timeout=_LOOK_AGAIN_MS, yield_on_timeout=True
            ):
                self._look_elsewhere()
        except OSError:
            return  # the folder has gone: nobody is told of others
        finally:
            self._notes.end()

    def _begin(self) -> Path | None:
        with self._lock:
            return self._notes.begin()

    def _look_elsewhere(self) -> None:
        found = self._notes.of_others()
        if found != self._elsewhere:
            with self._lock:
                self._elsewhere = found
            self._told(self.all())

    def _changed(self) -> None:
        with self._lock:
            pages = [{"id": str(number), **asdict(each)} for number, each in self._pages.items()]
            self._notes.write(pages)
        self._told(self.all())


class _Notes:
    """The file of this studio, and those of others in the same project."""

    def __init__(self, root: Path) -> None:
        state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
        project = hashlib.sha256(os.fsencode(root)).hexdigest()[:16]
        self._folder = Path(state) / "jausml" / "studios" / project
        self._file: Path | None = None
        self._descriptor = -1
        self._latest: list[dict[str, Any]] = []

    def begin(self) -> Path | None:
        """Makes the file of this studio; returns the folder of all, None without one."""
        if sys.platform == "win32":
            return None
        file = self._folder / f"{secrets.token_hex(8)}.json"
        with suppress(OSError):
            self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            # Nobody else sees it under this name before it is locked.
            new = file.with_suffix(".new")
            self._descriptor = os.open(new, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            new.replace(file)
            self._file = file
            self.write(self._latest)
            return self._folder
        return None

    def write(self, pages: list[dict[str, Any]]) -> None:
        """Notes the pages of this studio."""
        self._latest = pages
        if self._file is None:
            return
        data = json.dumps(pages).encode()
        with suppress(OSError):
            os.pwrite(self._descriptor, data, 0)
            os.ftruncate(self._descriptor, len(data))

    def of_others(self) -> dict[str, list[dict[str, Any]]]:
        """Returns the pages of other studios, by the name of each; what has ended is removed."""
        found: dict[str, list[dict[str, Any]]] = {}
        for each in self._folder.glob("*.json"):
            if each != self._file:
                pages = _pages_in(each)
                if pages:
                    found[each.stem] = pages
        return found

    def end(self) -> None:
        """Removes the file of this studio."""
        if self._file is not None:
            with suppress(OSError):
                self._file.unlink()
            os.close(self._descriptor)
        self._file = None


def _pages_in(file: Path) -> list[dict[str, Any]]:
    """Returns the pages that a file has, none when its studio has ended or is just writing."""
    try:
        with open_input(file) as opened:
            if _can_lock(opened.fileno()):
                file.unlink(missing_ok=True)
                return []
            said = json.loads(opened.read(_MOST_READ))
    except (OSError, ValueError):
        return []
    return [page for each in said if (page := _page(each))] if isinstance(said, list) else []


def _can_lock(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _page(said: object) -> dict[str, Any] | None:
    names = ("id", "name", "file", "view", "element")
    if not isinstance(said, dict) or not all(isinstance(said.get(each), str) for each in names):
        return None
    return {each: said[each] for each in names}
