"""The files of a recording: an MCAP file and the capture beside it, or a row of such pairs."""

from __future__ import annotations

import os
import re
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO, cast

from jausml.live.recording.mcap_files import McapFile, need_library
from jausml.live.traffic.frames import PcapWriter

if TYPE_CHECKING:
    from pathlib import Path

CAPTURE = ".pcap"
"""Ending of the capture that stands beside an MCAP file."""


@dataclass(frozen=True)
class SplitLimits:
    """When a recording goes on in new files, and how many of them stay; None for no limit.

    Attributes:
        size: Bytes of a pair of files.
        duration: Seconds of a pair of files.
    """

    size: int | None = None
    duration: float | None = None
    files: int | None = None

    @property
    def splits(self) -> bool:
        """Whether there is a row of files."""
        return self.size is not None or self.duration is not None


class FilePair:
    """An MCAP file and the capture beside it, which are being written."""

    def __init__(self, path: Path, compression: str, *, overwrites: bool) -> None:
        """Creates both."""
        mode = "wb" if overwrites else "xb"
        self.path, self.begun = path, time.monotonic()
        self._paths = (path, path.with_suffix(CAPTURE))
        with ExitStack() as stack:
            self._streams = [
                cast("BinaryIO", stack.enter_context(each.open(mode))) for each in self._paths
            ]
            self.file = McapFile(self._streams[0], has_jaus=True, compression=compression)
            self.capture = PcapWriter(self._streams[1])
            self.flush()
            self._written = stack.pop_all()

    @property
    def size(self) -> int:
        """Bytes of both files that the system has."""
        return sum(self._whole)

    def flush(self) -> None:
        """Gives the system what was written, in whole records."""
        self.file.flush()
        self._streams[1].flush()
        self._whole = [each.tell() for each in self._streams]

    def sync(self) -> None:
        """Waits until the disk has what the system has."""
        for each in self._streams:
            os.fsync(each.fileno())

    def close(self) -> None:
        """Ends both files, and waits until the disk has them."""
        with self._written:
            self.file.close()
            for each in self._streams:
                each.flush()
            self.sync()

    def give_up(self) -> None:
        """Leaves both files, of which the disk did not take all, as they were when it did."""
        with suppress(OSError):
            self._written.close()
        for path, size in zip(self._paths, self._whole, strict=True):
            with suppress(OSError):
                os.truncate(path, size)


class RecordingFiles:
    """The files of a recording, one pair after the other."""

    def __init__(
        self,
        path: Path,
        limits: SplitLimits,
        compression: str = "zstd",
        *,
        overwrites: bool = False,
    ) -> None:
        """Creates the first.

        Args:
            path: The MCAP file. A row of files has numbers before the ending, and goes on where
                one that is there ends.
        """
        need_library()
        self._path, self._limits, self._compression = path, limits, compression
        self._next = 1 + max((number for number, _ in _row(path)), default=-1)
        self.paths: list[Path] = []
        self.current = self._further() if limits.splits else self._part(path, overwrites=overwrites)
        self._forget()

    def turn(self) -> bool:
        """Begins new files when it is time; returns whether it was."""
        limits, current = self._limits, self.current
        is_full = limits.size is not None and current.size >= limits.size
        is_over = limits.duration is not None
        is_over = is_over and time.monotonic() - current.begun >= (limits.duration or 0.0)
        if not (is_full or is_over):
            return False
        self.current.close()
        self.current = self._further()
        self._forget()
        return True

    def _further(self) -> FilePair:
        """Begins the next files; numbers that another recorder has taken meanwhile are left out."""
        while True:
            path = self._path.with_stem(f"{self._path.stem}_{self._next}")
            self._next += 1
            try:
                return self._part(path, overwrites=False)
            except FileExistsError:
                continue

    def _part(self, path: Path, *, overwrites: bool) -> FilePair:
        part = FilePair(path, self._compression, overwrites=overwrites)
        self.paths.append(path)
        return part

    def _forget(self) -> None:
        """Removes the oldest files of the row that are more than are kept."""
        if self._limits.files is None:
            return
        for _, path in sorted(_row(self._path))[: -self._limits.files]:
            for each in (path, path.with_suffix(CAPTURE)):
                each.unlink(missing_ok=True)
            self.paths = [each for each in self.paths if each != path]


def _row(path: Path) -> list[tuple[int, Path]]:
    """Returns the files of a row that are there, with their numbers."""
    form = re.compile(rf"{re.escape(path.stem)}_(\d{{1,9}}){re.escape(path.suffix)}")
    found = ((form.fullmatch(each.name), each) for each in path.parent.iterdir())
    return [(int(match[1]), each) for match, each in found if match]
