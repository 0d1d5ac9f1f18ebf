"""The one door by which files of users come in and are replaced: regular files of a bounded size.

A link to a device, or a pipe in a folder that is checked, would otherwise stop a tool or fill the
memory of its machine. Recordings and captures are large on purpose, and may come by a pipe:
they are read as streams, in bounded pieces, by `cli/live/recordings.py` and `recording`.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import stat
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


def replace_file(path: Path, data: bytes) -> None:
    """Writes a file so that it is either old or new at any moment.

    Args:
        path: The file; a symbolic link is followed. A file that is there keeps its permissions.

    Raises:
        OSError: The file cannot be written; it is left as it was.
    """
    # Replacing the link itself would leave the file that it leads to as it was.
    real = Path(os.path.realpath(path))
    # In the same folder, since a rename across file systems is no single step.
    temporary = real.with_name(f".{real.name}.{os.getpid()}.jausml-tmp")
    try:
        temporary.write_bytes(data)
        if real.exists():
            shutil.copymode(real, temporary)
        temporary.replace(real)
    # An interrupt must not leave the temporary file behind either.
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            # Nobody but this function knows the temporary file.
            error.filename, error.filename2 = str(path), None
        raise


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
