"""The one door by which files of users come in: regular files of a bounded size.

A link to a device, or a pipe in a folder that is checked, would otherwise stop a tool or fill the
memory of its machine. Recordings and captures are large on purpose, and may come by a pipe:
they are read as streams, in bounded pieces, by `cli/live/recordings.py` and `recording`.
What a merge of lines leaves in files is found here too.
"""

from __future__ import annotations

import errno
import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

MOST_MIB = 64
"""The largest file that is read at once, in MiB, unless `LIMIT` says otherwise."""

LIMIT = "JAUSML_MAX_FILE_MIB"
"""The environment variable that raises or lowers the largest size."""

_BINARY = getattr(os, "O_BINARY", 0)


def open_input(path: str | os.PathLike[str]) -> BinaryIO:
    """Opens a file for reading, and never waits for it.

    Raises:
        OSError: It cannot be opened, or is no regular file; `strerror` says which.
    """
    # A pipe without a writer would hold up whoever opens it.
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | _BINARY)
    try:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
        if not (stat.S_ISREG(mode) or _is_null(descriptor)):
            raise OSError(errno.EINVAL, "it is no regular file", os.fspath(path))
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_input(path: str | os.PathLike[str]) -> bytes:
    """Returns the bytes of a file.

    Raises:
        OSError: It cannot be read, is no regular file or too large; `strerror` says which.
    """
    with open_input(path) as file:
        return bounded(file.read((_most_mib() << 20) + 1), path)


def bounded(data: bytes, path: str | os.PathLike[str]) -> bytes:
    """Returns the bytes of a file, unless it is too large.

    Raises:
        OSError: It is larger than the limit (`EFBIG`).
    """
    most = _most_mib()
    if len(data) > most << 20:
        reason = f"it is larger than {most} MiB ({LIMIT} sets the limit)"
        raise OSError(errno.EFBIG, reason, os.fspath(path))
    return data


def read_text(path: str | os.PathLike[str]) -> str:
    """Returns the text of a file, as UTF-8 and with line ends as Python has them.

    Raises:
        ValueError: It is no UTF-8, or no file can have this name.
    """
    return read_input(path).decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")


def leads_out(path: str | os.PathLike[str], root: Path) -> bool:
    """Tells whether a path leads out of a folder by its links."""
    return not Path(os.path.realpath(path)).is_relative_to(root)


def _is_null(descriptor: int) -> bool:
    """Tells whether an open file is the null device: git names it where a side has no file."""
    try:
        return os.path.samestat(os.fstat(descriptor), Path(os.devnull).stat())
    except OSError:
        return False


def _most_mib() -> int:
    limit = os.environ.get(LIMIT, "")
    return int(limit) if limit.isdecimal() and limit.isascii() and int(limit) else MOST_MIB


_MARKER = re.compile(rb"^(<{7}|={7}|>{7})(?:[ \r\n]|$)", re.MULTILINE)
_MOST_NAMED = 5

UNMERGED = "JML009"
UNMERGED_HINT = "keep what is meant, and remove the marks"


def unmerged(data: bytes) -> tuple[str, int]:
    """Returns a remark on all markers of conflicts, and the line of the first; empty for none.

    To be asked where a file cannot be read: some texts may hold such lines.
    """
    conflicts = list(_conflicts(data))
    if not conflicts:
        return "", 0
    places = [f"{first}-{last}" if last > first else f"{first}" for first, last in conflicts]
    more = [f"and {len(places) - _MOST_NAMED} more"] if len(places) > _MOST_NAMED else []
    shown = ", ".join([*places[:_MOST_NAMED], *more])
    return f"an unmerged conflict stands in lines {shown}", conflicts[0][0]


def _conflicts(data: bytes) -> Iterator[tuple[int, int]]:
    """Yields the first and the last line of each conflict."""
    first = last = at = 0
    line = 1
    for marker in _MARKER.finditer(data):
        line += data.count(b"\n", at, marker.start())
        at = marker.start()
        if first and marker[1].startswith(b"<"):
            yield first, last
            first = 0
        first, last = first or line, line
        if marker[1].startswith(b">"):
            yield first, last
            first = 0
    if first:
        yield first, last
