"""Pools: pieces of work in processes of this machine.

A piece, what all pieces share, and what becomes of one are values that can be pickled. Each process
makes a worker of what is shared, once, and asks it for one piece after another.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Generic, TypeVar

from jausml.live.workers.pool_processes import PoolProcesses

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

    def results(self, pieces: Sequence[Piece], jobs: int) -> Iterator[tuple[int, Result]]:
        """Yields the number of each piece and what became of it, in any order."""
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
