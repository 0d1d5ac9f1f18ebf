"""Capture files of the verbs: opened, with progress on a terminal; what could not be used."""

from __future__ import annotations

import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from jausml.cli.common import EnvironmentFault
from jausml.cli.messages import STDIN, reason_of, shown_path

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from jausml.live.traffic.frames import UdpReader

_STEPS = 200


class _Counted:
    """A stream that tells how much was read of it."""

    def __init__(self, stream: BinaryIO, bar: Any) -> None:
        self._stream = stream
        self._bar = bar

    def read(self, size: int = -1) -> bytes:
        """Returns what the stream gives."""
        data = self._stream.read(size)
        self._bar.update(len(data))
        return data


@contextmanager
def opened(path: str) -> Iterator[BinaryIO]:
    """Opens a file to be read from its beginning to its end.

    How far it is stands on stderr, if that is a terminal and no output runs on one.

    Args:
        path: The file; `-` is stdin.

    Raises:
        EnvironmentFault: It cannot be opened.
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
        if size and sys.stderr.isatty() and not sys.stdout.isatty():
            steps, label = max(1, size // _STEPS), shown_path(path)
            bar = stack.enter_context(
                click.progressbar(length=size, label=label, file=sys.stderr, update_min_steps=steps)
            )
            stream = _Counted(stream, bar)  # type: ignore[assignment]  # reads as captures do
        yield stream


def skipped_lines(reader: UdpReader, port: int) -> Iterator[str]:
    """Yields what a reader of frames has left out.

    Args:
        reader: The reader, which has read all.
        port: The UDP port that it looked for.
    """
    for reason, number in sorted(reader.skipped.items()):
        yield f"skipped {number} {reason}"
    if reader.elsewhere.unclaimed:
        what = f"skipped {reader.elsewhere.unclaimed} datagrams that look like JUDP"
        why = f"between endpoints that were not seen with port {port}; --port chooses another"
        yield f"{what}, {why}"
    if reader.unfinished:
        yield f"skipped {reader.unfinished} IP packets with missing fragments"
