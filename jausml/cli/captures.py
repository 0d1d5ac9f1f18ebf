"""Capture files of the verbs: opened, with progress on a terminal; what could not be used."""

from __future__ import annotations

import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from jausml.cli.common import EnvironmentFault
from jausml.cli.manners import step
from jausml.cli.messages import STDIN, reason_of, shown_path

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.cli.manners import Progress
    from jausml.live.traffic.frames import UdpReader


class _Counted:
    """A stream that tells how much was read of it."""

    def __init__(self, stream: BinaryIO, size: int, progress: Progress) -> None:
        self._stream = stream
        self._size = size
        self._progress = progress
        self._read = 0

    def read(self, size: int = -1) -> bytes:
        """Returns what the stream gives."""
        data = self._stream.read(size)
        self._read += len(data)
        self._progress.at(self._read / self._size)
        return data


@contextmanager
def opened(path: str) -> Iterator[BinaryIO]:
    """Opens a file to be read from its beginning to its end.

    How far it is stands on a terminal, if no output runs there (see `manners.step`).
    """
    if path == STDIN:
        yield sys.stdin.buffer
        return
    with ExitStack() as stack:
        try:
            stream: BinaryIO = stack.enter_context(Path(path).open("rb"))
            size = Path(path).stat().st_size
        except (OSError, ValueError) as error:
            raise EnvironmentFault(f"{shown_path(path)}: {reason_of(error)}") from error
        progress = stack.enter_context(step(f"reading {shown_path(path)}", prints=True))
        # It reads as captures do; of what has no size, such as a pipe, nobody knows the share.
        yield cast("BinaryIO", _Counted(stream, size, progress)) if size else stream


def skipped_lines(reader: UdpReader, port: int) -> Iterator[str]:
    """Yields what a reader of frames has left out."""
    for reason, number in sorted(reader.skipped.items()):
        yield f"skipped {number} {reason}"
    if reader.elsewhere.unclaimed:
        what = f"skipped {reader.elsewhere.unclaimed} datagrams that look like JUDP"
        why = f"between endpoints that were not seen with port {port}; --port chooses another"
        yield f"{what}, {why}"
    if reader.unfinished:
        yield f"skipped {reader.unfinished} IP packets with missing fragments"
