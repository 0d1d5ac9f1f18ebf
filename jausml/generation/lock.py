"""Lock of an output folder: two runs at once would each see half of what the other wrote."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from jausml.generation.errors import WriteError

if sys.platform != "win32":
    import fcntl

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@contextmanager
def locked(out: Path) -> Iterator[None]:
    """Waits until no other run writes into a folder, and keeps others out.

    The folder itself is locked, so that no file is left; it is made when it is missing, and removed
    when it stays empty. Windows has no such lock.
    """
    if sys.platform == "win32":
        yield
        return
    is_new = not out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(out, os.O_RDONLY)
    except OSError as error:
        raise WriteError(str(out), error.strerror or str(error)) from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
        if is_new:
            with suppress(OSError):
                out.rmdir()
