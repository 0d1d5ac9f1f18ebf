"""Recordings that pages look at: which files they may be, and those that are open, once for all."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from itertools import count, islice
from pathlib import Path

from jausml.authoring.proposals.elements import AnswerError
from jausml.language.model.project import walk
from jausml.live.recording.bags import MCAP
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.systems.playback import AT_ONCE, Indexing, RecordedSystem
from jausml.live.workers.pool import PoolError, PoolProcess

MOST_LISTED = 200
"""Files that are offered."""

MOST_OPEN = 4
"""Recordings that are open at once; the one that was asked for least recently is closed."""


class OpenedRecording:
    """A recording that a process of its own reads, from its beginning to its end.

    Attributes:
        share: How much of it is read, up to 1.
        fault: Why nothing of it can be read; empty otherwise.
        system: What it tells, None until all is read.
    """

    def __init__(self, path: Path, name: str) -> None:
        """Begins to read a file, which faults call by a name."""
        self.share, self.fault = 0.0, ""
        self.system: RecordedSystem | None = None
        self._path, self._name = path, name
        self._process = PoolProcess(Indexing, str(path))
        self._thread = threading.Thread(target=self._read, name="recording", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Reads no more."""
        self._process.close()
        self._thread.join()

    def _read(self) -> None:
        answer: float | RecordedSystem = 0.0
        try:
            while isinstance(answer, float):
                self.share = answer
                answer = self._process.ask(AT_ONCE)
            self.system = answer
        except (RecordingError, OSError, PoolError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            self.fault = reason.replace(str(self._path), self._name)
        finally:
            self._process.close()


class Recordings:
    """The recordings of a folder, and those that were named when the studio was started."""

    def __init__(self, root: Path, paths: Iterable[Path] = ()) -> None:
        """Opens nothing yet."""
        self._root = root.resolve()
        self._named_files = _named(self._root, paths)
        self.given = tuple(self._named_files)
        """Names of those that were named at the start."""
        self._opened: OrderedDict[tuple[str, int, int], OpenedRecording] = OrderedDict()
        self._lock = threading.Lock()

    def files(self) -> list[str]:
        """Returns the names of those that may be opened."""
        paths = islice(walk(str(self._root), (MCAP,), lambda _: None), MOST_LISTED)
        below = (Path(path).relative_to(self._root).as_posix() for path in paths)
        return list(dict.fromkeys((*self._named_files, *below)))

    def opened(self, name: str) -> OpenedRecording:
        """Returns a recording, which is being read from the first question on.

        A file that has changed is read again.

        Raises:
            AnswerError: There is none of this name.
        """
        path = self._path(name)
        try:
            status = path.stat()
        except OSError as error:
            raise AnswerError(f"{name}: {error.strerror}") from error
        key = name, status.st_mtime_ns, status.st_size
        with self._lock:
            if key not in self._opened:
                self._opened[key] = OpenedRecording(path, name)
            self._opened.move_to_end(key)
            old = [
                opened_key
                for opened_key in self._opened
                if opened_key[0] == name and opened_key != key
            ]
            old += list(self._opened)[: max(0, len(self._opened) - len(old) - MOST_OPEN)]
            closed = [self._opened.pop(opened_key) for opened_key in dict.fromkeys(old)]
            # Another request may push it out as soon as the lock is free.
            opened = self._opened[key]
        for opened_recording in closed:
            opened_recording.close()
        return opened

    def system(self, name: str) -> RecordedSystem:
        """Returns the recorded system of a recording.

        Raises:
            AnswerError: There is none of this name, or it is not read yet, or cannot be.
        """
        opened_recording = self.opened(name)
        if opened_recording.system is None:
            raise AnswerError(opened_recording.fault or f"{name} is still being read")
        return opened_recording.system

    def close(self) -> None:
        """Closes all."""
        with self._lock:
            closed = list(self._opened.values())
            self._opened.clear()
        for opened_recording in closed:
            opened_recording.close()

    def _path(self, name: str) -> Path:
        """Returns the file of a name: one from the command line, or one of the folder."""
        if name in self._named_files:
            return self._named_files[name]
        try:
            path = (self._root / name).resolve()
            is_below = path.is_relative_to(self._root) and path.is_file()
        except (OSError, ValueError):
            is_below = False
        if not is_below or not name.endswith(MCAP) or path.suffix != MCAP:
            raise AnswerError(f"the folder has no recording {name[:200]!r}")
        return path


def _named(root: Path, files: Iterable[Path]) -> Mapping[str, Path]:
    """Returns files by the names that pages know: paths below the folder, else their last part."""
    files_by_name: dict[str, Path] = {}
    for file in files:
        path = file.resolve()
        name = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name
        numbered = (f"{name} ({number})" for number in count(2))
        while files_by_name.get(name, path) != path:
            name = next(numbered)
        files_by_name[name] = path
    return files_by_name
