"""Pools: pieces of work in processes of this machine, or of those of a scheduler of Dask.

A piece, what all pieces share, and what becomes of one are values that can be pickled. Each process
makes a worker of what is shared, once, and asks it for one piece after another.
"""

from __future__ import annotations

import contextlib
import pickle
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from jausml import installing
from jausml.live.workers.pool_processes import PoolError, PoolProcesses

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Executor

_PERIOD = 5.0
_NO_DASK = f"a scheduler of Dask needs the extra `dask`: {installing.command('dask')}"

Shared = TypeVar("Shared")
Piece = TypeVar("Piece")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Work(Generic[Shared, Piece, Result]):
    """What is done with each piece.

    Attributes:
        make: Makes the worker of a process; it can be imported, and so can the worker.
        shared: What it is given.
    """

    make: Callable[[Shared], Callable[[Piece], Result]]
    shared: Shared

    @property
    def begin(self) -> bytes:
        """What a process is told first."""
        return pickle.dumps((self.make, self.shared))

    def results(
        self, pieces: Sequence[Piece], jobs: int, scheduler: str = ""
    ) -> Iterator[tuple[int, Result]]:
        """Yields the number of each piece and what became of it, in any order."""
        if scheduler:
            try:
                from jausml.live.workers.pool_of_dask import of_dask  # noqa: PLC0415 - an extra
            except ImportError as error:
                raise PoolError(_NO_DASK) from error
            with of_dask(self.begin, scheduler) as pool:
                yield from _done(*pool, pieces)
        else:
            with _of_processes(self, max(1, min(jobs, len(pieces)))) as pool:
                yield from _done(*pool, pieces)


def _done(
    executor: Executor, ask: Callable[[Any], Any], check: Callable[[], None], pieces: Sequence[Any]
) -> Iterator[tuple[int, Any]]:
    waiting = {executor.submit(ask, each): number for number, each in enumerate(pieces)}
    while waiting:
        done, _ = wait(waiting, _PERIOD, FIRST_COMPLETED)
        if not done:
            check()
        for each in done:
            yield waiting.pop(each), each.result()


@contextlib.contextmanager
def _of_processes(
    work: Work[Any, Any, Any], jobs: int
) -> Iterator[tuple[Executor, Callable[[Any], Any], Callable[[], None]]]:
    processes = PoolProcesses(work.begin)
    with ThreadPoolExecutor(jobs) as executor:
        try:
            yield executor, processes.ask, lambda: None
        finally:
            executor.shutdown(wait=False, cancel_futures=True)
            processes.close()
