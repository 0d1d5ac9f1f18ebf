"""A process at a terminal of its own, as somebody sits before it."""

import contextlib
import os
import pty
import re
import select
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

_ESCAPE = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
BOUND = 60.0
"""Seconds after which what was waited for does not come."""


class Terminal:
    """What a process writes to its terminal, and what is typed there."""

    def __init__(self, descriptor: int, process: subprocess.Popen[bytes]) -> None:
        self._descriptor, self._process = descriptor, process
        self.shown = ""

    def type(self, text: str) -> None:
        """Types a text."""
        os.write(self._descriptor, text.encode())

    def wait_for(self, text: str, after: int = 0) -> None:
        """Reads until a text is shown, whatever its colours are.

        Args:
            text: The text.
            after: Where in what was shown the search begins.
        """
        end = time.monotonic() + BOUND
        while text not in _ESCAPE.sub("", self.shown[after:]):
            assert self._read(end - time.monotonic()), f"no {text!r} in {self.shown!r}"

    def read_all(self) -> str:
        """Reads until the process has closed the terminal; returns all that was shown."""
        end = time.monotonic() + BOUND
        while self._read(end - time.monotonic()):
            pass
        return self.shown

    def status(self) -> int:
        """Waits until the process has ended; returns its exit status."""
        return self._process.wait(BOUND)

    def _read(self, seconds: float) -> bool:
        ready, _, _ = select.select([self._descriptor], [], [], max(seconds, 0))
        if not ready:
            return False
        try:
            data = os.read(self._descriptor, 65536)
        except OSError:  # Linux says so when the other end is closed
            return False
        self.shown += data.decode(errors="replace")
        return bool(data)


@contextlib.contextmanager
def at_terminal(
    *command: str | Path,
    cwd: Path,
    environment: Mapping[str, str] | None = None,
    output: int | None = None,
) -> Iterator[Terminal]:
    """Runs a process at a terminal, and ends it with the block.

    Args:
        command: Program and arguments.
        cwd: Its folder.
        environment: Variables beside those of this process.
        output: Where its stdout goes instead of the terminal.
    """
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        list(map(str, command)),
        cwd=cwd,
        env={**os.environ, "TERM": "xterm", **(environment or {})},
        stdin=theirs,
        stdout=theirs if output is None else output,
        stderr=theirs,
        start_new_session=True,
    )
    os.close(theirs)
    try:
        yield Terminal(ours, process)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        os.close(ours)
