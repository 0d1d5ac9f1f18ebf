"""Pools: pieces of work in processes of this machine.

Pieces, their shared value and their results can be pickled. Each process makes a worker of the
shared value, once, and calls it for one piece after another.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

_SCRIPT = Path(__file__).with_name("pool_process.py")


class PoolError(Exception):
    """A pool that cannot work, or has ended; the text says why."""


class PoolProcess:
    """A process that works on one piece at a time; close it at the end."""

    def __init__(self, begin: bytes) -> None:
        # All temporary files are in a folder that is removed, however the process ends.
        self._folder = tempfile.TemporaryDirectory(
            prefix="jausml_pool_", ignore_cleanup_errors=True
        )
        self._process = subprocess.Popen(  # noqa: S603 - our own script
            [sys.executable, str(_SCRIPT), self._folder.name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "TMPDIR": self._folder.name},
            start_new_session=True,
        )
        self._begin = begin

    def ask(self, piece: Any) -> Any:
        """Returns the result of a piece of work; raises what the worker raises."""
        try:
            is_made, answer = self._answer(self._begin + pickle.dumps(piece))
        except (OSError, EOFError, ValueError, pickle.UnpicklingError) as error:
            raise PoolError("a process of the work has ended") from error
        self._begin = b""
        if not is_made:
            raise answer
        return answer

    def _answer(self, request: bytes) -> tuple[bool, Any]:
        requests, answers = self._process.stdin, self._process.stdout
        if requests is None or answers is None:
            raise EOFError
        requests.write(request)
        requests.flush()
        answer: tuple[bool, Any] = pickle.load(answers)  # noqa: S301 - of our own script
        return answer

    def close(self) -> None:
        """Ends the process, and its children."""
        with contextlib.suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):  # with data that was not read
                    pipe.close()
        self._folder.cleanup()


class PoolProcesses:
    """Processes for threads that call at the same time, one for each; close them at the end."""

    def __init__(self, begin: bytes) -> None:
        self._begin = begin
        self._idle: queue.SimpleQueue[PoolProcess] = queue.SimpleQueue()
        self._all: list[PoolProcess] = []
        self._lock = threading.Lock()
        self._is_closed = False

    def ask(self, piece: Any) -> Any:
        """Returns the result of a piece of work; raises what the worker raises."""
        process = self._taken()
        answer = process.ask(piece)
        self._idle.put(process)
        return answer

    def _taken(self) -> PoolProcess:
        with contextlib.suppress(queue.Empty):
            return self._idle.get_nowait()
        with self._lock:
            if self._is_closed:
                raise PoolError("the work is over")
            self._all.append(PoolProcess(self._begin))
            return self._all[-1]

    def close(self) -> None:
        """Ends all processes."""
        with self._lock:
            self._is_closed = True
            for pool_process in self._all:
                pool_process.close()


Shared = TypeVar("Shared")
Piece = TypeVar("Piece")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Work(Generic[Shared, Piece, Result]):
    """The work on each piece.

    Attributes:
        make: Makes the worker of a process; both can be imported.
        shared: The argument of `make`.
    """

    make: Callable[[Shared], Callable[[Piece], Result]]
    shared: Shared

    @property
    def begin(self) -> bytes:
        """The first bytes for a process."""
        return pickle.dumps((self.make, self.shared))

    def results(self, pieces: Sequence[Piece], jobs: int) -> Iterator[tuple[int, Result]]:
        """Yields the number of each piece and its result, in any order."""
        processes = PoolProcesses(self.begin)
        with ThreadPoolExecutor(max(1, min(jobs, len(pieces)))) as executor:
            try:
                numbers = {
                    executor.submit(processes.ask, piece): number
                    for number, piece in enumerate(pieces)
                }
                for answer in as_completed(numbers):
                    yield numbers[answer], answer.result()
            finally:
                executor.shutdown(wait=False, cancel_futures=True)
                processes.close()
