"""A log of what happened when, one CSV row for each event, for the evaluation of a run."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TextIO

FOLDER_VARIABLE = "CATVEHICLE_LOG"
"""Environment variable that names the folder of the logs; without it nothing is written."""


class EventLog:
    """Appends rows to a file, each at once, so that a killed process leaves whole rows.

    Args:
        path: The file; None writes nothing.
    """

    def __init__(self, path: Path | None) -> None:
        self._file: TextIO | None = None
        if path is not None:
            self._file = path.open("w", encoding="utf-8", buffering=1)

    @classmethod
    def from_environment(cls, name: str) -> EventLog:
        """Returns the log of a process: `<name>.csv` in the folder that the environment names."""
        folder = os.environ.get(FOLDER_VARIABLE)
        return cls(Path(folder) / f"{name}.csv" if folder else None)

    @property
    def is_open(self) -> bool:
        """Whether rows are kept."""
        return self._file is not None

    def write(self, *cells: str | int | float) -> None:
        """Writes one row; numbers keep all their digits."""
        if self._file is not None:
            self._file.write(",".join(map(str, cells)) + "\n")

    def close(self) -> None:
        """Closes the file; nothing is written afterwards."""
        if self._file is not None:
            self._file.close()
            self._file = None


def read_events(path: Path) -> list[list[str]]:
    """Returns the rows of a log; empty when there is no file."""
    if not path.exists():
        return []
    return [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
