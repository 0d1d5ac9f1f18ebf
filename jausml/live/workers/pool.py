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
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any, TypeVar

_SCRIPT = Path(__file__).with_name("pool_process.py")


class PoolError(Exception):
    """A pool that cannot work, or has ended; the text says why."""


class PoolProcess:
    """A process that works on one piece at a time; close it at the end."""

    def __init__(self, make: Callable[[Any], Callable[[Any], Any]], shared: Any) -> None:
        """Starts the process, which makes its worker of `shared`; both can be pickled."""
        # Goes with the first piece.
        self._begin = pickle.dumps((make, shared))
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

    def ask(self, piece: Any) -> Any:
        """Returns the result of a piece of work; raises what the worker raises, or PoolError."""
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


Shared = TypeVar("Shared")
Piece = TypeVar("Piece")
Result = TypeVar("Result")


def work_on(
    pieces: Sequence[Piece],
    jobs: int,
    make: Callable[[Shared], Callable[[Piece], Result]],
    shared: Shared,
) -> Iterator[tuple[int, Result]]:
    """Yields the number of each piece and its result, in any order.

    Args:
        jobs: How many processes work at once.
        make: Makes the worker of a process of `shared`.

    Raises:
        PoolError: A process has ended.
        Exception: What a worker raises.
    """
    count = max(1, min(jobs, len(pieces)))
    processes: list[PoolProcess] = []
    idle: queue.SimpleQueue[PoolProcess] = queue.SimpleQueue()

    def ask(piece: Piece) -> Any:
        # There are as many processes as threads, so that one is always idle.
        process = idle.get()
        try:
            return process.ask(piece)
        finally:
            idle.put(process)

    with ThreadPoolExecutor(count) as executor:
        try:
            for _ in range(count):
                processes.append(PoolProcess(make, shared))
                idle.put(processes[-1])
            numbers = {executor.submit(ask, piece): number for number, piece in enumerate(pieces)}
            for answer in as_completed(numbers):
                yield numbers[answer], answer.result()
        finally:
            executor.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.close()
