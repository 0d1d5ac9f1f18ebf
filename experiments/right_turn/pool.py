"""Many drives in virtual time, in as many processes as shall work at once."""

from __future__ import annotations

import logging
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from multiprocessing import get_context
from typing import TYPE_CHECKING

from catvehicle.metrics import closeness, gap

from experiments.right_turn.data import Run
from experiments.right_turn.generated import Workspace
from experiments.right_turn.loops import Conditions, drive
from experiments.right_turn.record import PERIOD

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path
    from types import TracebackType

    from catvehicle.metrics import Sample
PROCESSES = 2
"""Drives at once; each keeps one processor busy."""

SHIFTS = (0.0, 0.1, 0.25)
"""Shifts in time (s) for which it is told how close two drives are."""


@dataclass(frozen=True)
class Task:
    """A drive to be made.

    Attributes:
        name: Name of the run.
        conditions: What it meets.
        workspace: Folder of the generated code of its system.
        system: Name of the system in the results; that of the conditions when empty.
        reference: Folder of the run that it is compared with; None compares with none.
        folder: Folder into which it is written; None keeps no samples of it.
    """

    name: str
    conditions: Conditions
    workspace: Path
    system: str = ""
    reference: Path | None = None
    folder: Path | None = None


class Pool:
    """Processes that drive; use it in a `with` statement."""

    def __init__(self) -> None:
        """Start the processes when they are needed."""
        self._executor = ProcessPoolExecutor(
            PROCESSES, mp_context=get_context("spawn"), initializer=_begin
        )

    def __enter__(self) -> Pool:
        """Return the pool."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """End the processes; what has not begun is left out."""
        self._executor.shutdown(cancel_futures=True)

    def drive(self, tasks: Sequence[Task], done: Callable[[], object]) -> list[Run]:
        """Make drives and return them in the order of the tasks.

        Args:
            tasks: What to drive. What is compared with others names runs that are written already.
            done: Called after each drive.
        """
        runs = []
        for run in self._executor.map(_work, tasks):
            runs.append(run)
            done()
        return runs


def _begin() -> None:
    # What a drive counts is in its results; what fails in it ends it.
    logging.getLogger("jausml").setLevel(logging.CRITICAL)


@lru_cache(maxsize=8)
def _workspace(folder: Path) -> Workspace:
    return Workspace.at(folder)


def _work(task: Task) -> Run:
    run = drive(task.conditions, _workspace(task.workspace), task.name)
    metrics = dict(run.metrics)
    if task.reference is not None:
        metrics |= compared(_reference(task.reference), run)
    run = replace(run, system=task.system or run.system, metrics=metrics)
    if task.folder is not None:
        run.write(task.folder)
        return run
    return replace(run, samples=(), steps=(), events=(), latencies={})


@lru_cache(maxsize=64)
def _reference(folder: Path) -> Run:
    return Run.read(folder)


def compared(first: Run, second: Run) -> dict[str, float]:
    """Returns how far the second of two drives is from the first; nothing without motion."""
    if not (first.samples and second.samples):
        return {}
    longest = max(len(first.samples), len(second.samples))
    one, two = standing(first.samples, longest), standing(second.samples, longest)
    found = gap(one, two)
    excess = second.metrics["path_error_max"] - first.metrics["path_error_max"]
    return {
        "path_error_excess": excess,
        "gap_position": found.position,
        "gap_speed_rms": found.speed_rms,
        "gap_steering_rms": found.steering_rms,
        "activity_ratio": found.activity_ratio,
        **{f"closeness_{1000 * shift:.0f}ms": closeness(one, two, shift) for shift in SHIFTS},
    }


def standing(samples: Sequence[Sample], length: int) -> list[Sample]:
    """Returns a drive with so many samples: at its end the vehicle stands where it is."""
    last = samples[-1]
    more = (replace(last, t=PERIOD * number) for number in range(len(samples), length))
    return [*samples, *more]
