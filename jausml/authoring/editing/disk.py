"""The files of a folder as they are stored, and nothing outside of it."""

from __future__ import annotations

import os
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.language.model.inputs import read_input
from jausml.language.model.xmi.writer import replace_file

if TYPE_CHECKING:
    from collections.abc import Iterator


if sys.platform != "win32":
    import fcntl

_PATIENCE, _STEP = 2.0, 0.005
"""Seconds that is waited for others to have stored, and from one look to the next."""


def _is_locked(descriptor: int) -> bool:
    """Locks what is open unless another has; also where there are no locks."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


class Disk:
    """The files below a folder."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._is_alone = False

    def read(self, file: str) -> bytes | None:
        """Returns what is stored of a file, None when it is not there."""
        path = self._root / file
        if not Path(os.path.realpath(path)).is_relative_to(self._root):
            raise EditError(f"{file} lies outside the opened folder")
        try:
            return read_input(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise EditError(f"{file} cannot be read: {error.strerror}") from error

    def readable(self, file: str) -> bytes | None:
        """Returns what is stored of a file, None also when it cannot be read."""
        try:
            return self.read(file)
        except EditError:
            return None

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keeps other projects of this folder from storing as long as the context lasts.

        One thread at a time may ask, also within such a context.

        The folder itself is locked, so that no file is left. Windows, and some file systems, have
        no such lock.

        Raises:
            EditError: Another one has stored for longer than anybody waits.
        """
        if sys.platform == "win32" or self._is_alone:
            yield
            return
        descriptor = os.open(self._root, os.O_RDONLY)
        try:
            end = time.monotonic() + _PATIENCE
            while not _is_locked(descriptor):
                if time.monotonic() > end:
                    message = "another program has been writing into the folder for too long"
                    raise EditError(message, conflict=True)
                time.sleep(_STEP)
            self._is_alone = True
            yield
        finally:
            self._is_alone = False
            os.close(descriptor)

    def store(self, file: str, data: bytes | None) -> None:
        """Stores a file, which is old or new at any moment; None deletes it.

        Raises:
            OSError: It cannot be stored; it is left as it was.
        """
        path = self._root / file
        if data is None:
            path.unlink(missing_ok=True)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, data)
