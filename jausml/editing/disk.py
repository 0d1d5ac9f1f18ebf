"""The files of a folder as they are stored, and nothing outside of it."""

from __future__ import annotations

import os
from pathlib import Path

from jausml.editing.commands import EditError
from jausml.model.xmi.writer import replace_file


class Disk:
    """The files below a folder.

    Args:
        root: The folder, symbolic links followed.
    """

    def __init__(self, root: Path) -> None:
        self._root = root

    def read(self, file: str) -> bytes | None:
        """Returns what is stored of a file, None when it is not there.

        Args:
            file: The file, relative to the folder with forward slashes.

        Raises:
            EditError: It lies outside the folder, or cannot be read.
        """
        path = self._root / file
        if not Path(os.path.realpath(path)).is_relative_to(self._root):
            raise EditError(f"{file} lies outside the opened folder")
        try:
            return path.read_bytes()
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
