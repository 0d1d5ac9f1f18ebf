"""Files of recordings and captures: opened, written, and what could not be used of them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

import click

from jausml.cli.shared.files import STDIN, EnvironmentFault, cannot_write, ending_at, shown_path
from jausml.cli.shared.terminal import Progress, step, warn

if TYPE_CHECKING:
    from jausml.live.traffic.frames import UdpReader
    from jausml.runtime.base.settings import TransportSettings

output_option = click.option("-o", "--output", metavar="FILE", help="MCAP file to write.")
force_option = click.option("--force", is_flag=True, help="Overwrite FILE.")


def transport_settings(interface: str, port: int, multicast_group: str) -> TransportSettings:
    """Returns where JAUS is listened to."""
    from jausml.runtime.base.settings import TransportSettings

    with ending_at(ValueError, kind=click.UsageError):
        return TransportSettings(interface=interface, port=port, multicast_group=multicast_group)


@contextmanager
def written(path: str, *, force: bool) -> Iterator[BinaryIO]:
    """Opens a file for writing."""
    try:
        with Path(path).open("wb" if force else "xb") as stream:
            yield stream
    except FileExistsError as error:
        raise already_there(path) from error
    except OSError as error:
        raise cannot_write(path, error) from error


def not_itself(recording: str, output: str) -> None:
    """Raises UsageError where a recording would be written over itself."""
    try:
        is_same = Path(recording).samefile(output)
    except (OSError, ValueError):  # one is not there, which others tell
        return
    if is_same:
        raise click.UsageError(f"{click.format_filename(output)} would be written over itself")


def already_there(path: str) -> EnvironmentFault:
    """Returns the error of a file that would be overwritten."""
    return EnvironmentFault(
        f"{click.format_filename(path)} is there already; --force overwrites it"
    )


def shown_time(seconds: float) -> str:
    """Returns a time as people read it, of the world and to the millisecond."""
    return datetime.fromtimestamp(seconds, tz=timezone.utc).isoformat(" ", "milliseconds")


def warn_if_damaged(path: str, fault: str, reached: int | None) -> bool:
    """Warns of the part of a recording that cannot be read; returns whether there is one.

    Args:
        fault: What is wrong with it; empty for nothing.
        reached: The time of the last message that could be read, in nanoseconds; None for none.
    """
    if fault and reached is not None:
        until = shown_time(reached / 1e9)
        warn(f"{shown_path(path)} is not whole: {fault}; it was read until {until}")
    return bool(fault)


class _Counted:
    """A stream that tells how much was read of it."""

    def __init__(self, stream: BinaryIO, size: int, progress: Progress) -> None:
        self._stream = stream
        self._size = size
        self._progress = progress
        self._read = 0

    def read(self, size: int = -1) -> bytes:
        """Returns the next bytes of the stream."""
        data = self._stream.read(size)
        self._read += len(data)
        self._progress.at(self._read / self._size)
        return data


@contextmanager
def opened(path: str) -> Iterator[BinaryIO]:
    """Opens a file to be read from its beginning to its end.

    How far it is stands on a terminal, if no output runs there (see `terminal.step`).
    """
    if path == STDIN:
        yield sys.stdin.buffer
        return
    with ExitStack() as stack:
        with ending_at(OSError, ValueError, about=f"{shown_path(path)}: "):
            stream: BinaryIO = stack.enter_context(Path(path).open("rb"))
            size = Path(path).stat().st_size
        progress = stack.enter_context(step(f"reading {shown_path(path)}", prints=True))
        # It reads as captures do; of what has no size, such as a pipe, nobody knows the share.
        yield cast("BinaryIO", _Counted(stream, size, progress)) if size else stream


def skipped_lines(reader: UdpReader, port: int) -> Iterator[str]:
    """Yields the frames that a reader has left out, counted by reason."""
    for reason, number in sorted(reader.skipped.items()):
        yield f"skipped {number} {reason}"
    if reader.other_ports.unclaimed:
        what = f"skipped {reader.other_ports.unclaimed} datagrams that look like JUDP"
        why = f"between endpoints that were not seen with port {port}; --port chooses another"
        yield f"{what}, {why}"
    if reader.unfinished:
        yield f"skipped {reader.unfinished} IP packets with missing fragments"
