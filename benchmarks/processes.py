"""Processes of a run: started, looked at, ended; none outlives it."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Self

GRACE = 5.0
"""Seconds that a process has to end."""


class Child:
    """A Python process of the run.

    Attributes:
        started: When it was started, by the monotonic clock.
    """

    def __init__(
        self, arguments: Sequence[str | Path], environment: Mapping[str, str], log: Path
    ) -> None:
        """Starts it.

        Args:
            arguments: What follows `python`.
            environment: Its environment.
            log: File to which it adds what it reports.
        """
        self.started = time.monotonic()
        with log.open("a", encoding="utf-8") as errors:
            self.process = subprocess.Popen(
                [sys.executable, *map(str, arguments)],
                env=dict(environment),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
            )
        self._proc = Path(f"/proc/{self.process.pid}")

    @property
    def is_alive(self) -> bool:
        """Whether it runs."""
        return self.process.poll() is None

    def processor_time(self) -> float:
        """Returns the seconds that all its threads have had a processor."""
        total = 0
        for task in (self._proc / "task").iterdir():
            with contextlib.suppress(OSError):
                total += int((task / "schedstat").read_text().split()[0])
        return total / 1e9

    def memory(self) -> float:
        """Returns its resident memory in MiB."""
        status = (self._proc / "status").read_text()
        (line,) = (
            status_line for status_line in status.splitlines() if status_line.startswith("VmRSS")
        )
        return int(line.split()[1]) / 1024

    def end(self) -> None:
        """Ends it, by force if it must be."""
        if self.is_alive:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(GRACE)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                stream.close()


class Children:
    """Processes that end together."""

    def __init__(self, environment: Mapping[str, str], log: Path) -> None:
        """Starts none.

        Args:
            environment: Their environment.
            log: File to which they add what they report.
        """
        self._environment = environment
        self._log = log
        self._all: list[Child] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        self.end()

    def start(self, *arguments: str | Path) -> Child:
        """Starts `python ARGUMENTS`."""
        child = Child(arguments, self._environment, self._log)
        self._all.append(child)
        return child

    def end(self) -> None:
        """Ends all, together."""
        for child in self._all:
            if child.is_alive:
                child.process.send_signal(signal.SIGTERM)
        for child in self._all:
            child.end()
        self._all.clear()
