"""Runs of proofs: all values of narrow numbers, of wide ones as far as time goes, in a pool."""

from __future__ import annotations

import os
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from jausml.generation.native import COMPILERS, compiler
from jausml.language.model import Model
from jausml.language.project import OneDocument, one_document
from jausml.live.workers.pool import PoolError, work_on
from jausml.live.workers.worker import WorkerError
from jausml.proving.compiled_form import (
    NAME,
    CompiledForm,
    ProgramError,
    PythonForm,
    Tally,
    compiled,
    proof_code,
)
from jausml.proving.plan import Field, plan
from jausml.proving.positions import positions_of
from jausml.proving.results import MapResult
from jausml.proving.round_trips import RoundTrip, round_trips
from jausml.proving.summary import EXAMPLES, Swept, summed_up

NARROW = 16
"""Bits of numbers of which all values are tried in whole messages."""

WIDEST = 32
"""Bits of the widest numbers of which all values may be tried."""

_DIRECTED, _DIRECTED_OF_MORE = 1 << 16, 1 << 14
"""How many values are tried of numbers of more than 16 bits, and of more than 32."""

_TRIED = 1 << 18  # values by which it is found out how long all would take


@dataclass(frozen=True)
class Settings:
    """How proofs run.

    Attributes:
        program: The C++ compiler.
        budget: Seconds for all values of numbers of more than 16 bits, where they can be tried.
        jobs: How many processes run at once.
    """

    program: str
    budget: float
    jobs: int


def prove(model: Model, trips: Iterable[RoundTrip], settings: Settings) -> Iterator[MapResult]:
    """Yields the results of the proofs of maps, in their order.

    Raises:
        ProgramError: A map cannot be compiled, or its program has ended.
        WorkerError: Its Python code has ended.
    """
    deadline = time.monotonic() + settings.budget
    for trip in trips:
        yield _proved(model, trip, settings, deadline)


def unproved(trip: RoundTrip) -> MapResult:
    """Returns the result of a map of which nothing is known yet."""
    return MapResult(trip.name, str(trip.to_ros.message.name), str(trip.to_ros.type.name))


def _proved(model: Model, trip: RoundTrip, settings: Settings, deadline: float) -> MapResult:
    begun = time.monotonic()
    code = proof_code(model, trip)
    result = unproved(trip)
    if not code.directions:
        result.remarks = [f"left to Python: {reason}" for reason in code.reasons]
        return result
    with (
        tempfile.TemporaryDirectory(prefix="jausml_proof_") as folder,
        CompiledForm(compiled(code, Path(folder), settings.program)) as form,
        closing(PythonForm(code.python, NAME)) as python,
    ):
        planned = plan(code, form, trip)
        result.not_carried, result.remarks = planned.not_carried, planned.remarks
        for field in planned.fields:
            sweep_result = _swept(form, field, settings.jobs, deadline)
            result.fields.append(summed_up(trip, field, sweep_result, python, form))
    result.seconds = time.monotonic() - begun
    return result


def _swept(form: CompiledForm, planned: Field, jobs: int, deadline: float) -> Swept:
    """Returns the tallies of the values of a number.

    Args:
        deadline: When sweeps over all values of wide numbers should have ended, by the monotonic
            clock.
    """
    sweep, bits = planned.sweep, planned.number.bits
    total = 1 << bits
    count = _DIRECTED if bits <= WIDEST else _DIRECTED_OF_MORE
    indices = range(total) if bits <= NARROW else positions_of(planned.number, count)
    most = total if bits <= NARROW else EXAMPLES
    sweep_result = Swept(form.run(sweep, indices, most, jobs))
    if planned.partners:
        mixed = replace(sweep, varied=planned.partners)
        sweep_result = replace(sweep_result, mixed=form.run(mixed, indices, most, jobs))
    if not NARROW < bits <= WIDEST:
        return sweep_result
    if planned.shortcut:
        # The shortcut counts only if it finds the same in the values that went through both.
        short = replace(sweep, shortcut=planned.shortcut)
        if _is_alike(sweep_result.tally, form.run(short, indices, most, jobs)):
            sweep = short
    begun = time.monotonic()
    form.run(sweep, range(total // 2, total // 2 + _TRIED), most)
    seconds = (time.monotonic() - begun) * total / _TRIED / jobs
    if seconds > deadline - time.monotonic():
        return replace(sweep_result, needs=seconds)
    return replace(sweep_result, wide=form.run(sweep, range(total), most, jobs))


def _is_alike(whole: Tally, short: Tally) -> bool:
    """Tells whether a sweep without the rest of the message has the same result."""
    counts = ("count", "unchanged", "changed", "others", "left_out", "left", "drifting")
    names = (*counts, "largest", "largest_drift")
    return all(getattr(whole, name) == getattr(short, name) for name in names)


def processors() -> int:
    """Returns how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class _Shared:
    """The shared value of a pool; the monotonic clock is the same in all of its processes."""

    document: OneDocument
    settings: Settings
    deadline: float


def _prover(shared: _Shared) -> Callable[[tuple[str, int]], MapResult]:
    """Returns the prover of single maps, by name and number among those of this name.

    The number among all would not do: the one document may have the maps in another order.
    """
    model = shared.document.read().model
    trips = round_trips(model)

    def prove_one(piece: tuple[str, int]) -> MapResult:
        name, number = piece
        trip = [trip for trip in trips if trip.name == name][number]
        return _proved_or_failed(model, trip, shared.settings, shared.deadline)

    return prove_one


def prove_all(
    model: Model, trips: Sequence[RoundTrip], settings: Settings
) -> Iterator[tuple[int, MapResult]]:
    """Yields the numbers of maps and the results of their proofs, in any order.

    A proof that fails has the error in its result.

    Args:
        trips: Maps of the model, of each name all; at least one.
    """
    deadline = time.monotonic() + settings.budget
    if min(settings.jobs, len(trips)) == 1:
        for number, trip in enumerate(trips):
            yield number, _proved_or_failed(model, trip, settings, deadline)
        return
    threads = max(1, settings.jobs // len(trips))
    shared = _Shared(one_document(model), replace(settings, jobs=threads), deadline)
    seen: Counter[str] = Counter()
    pieces = []
    for trip in trips:
        pieces.append((trip.name, seen[trip.name]))
        seen[trip.name] += 1
    yield from work_on(pieces, settings.jobs, _prover, shared)


def program() -> str:
    """Returns the C++ compiler of this machine; raises PoolError if there is none."""
    executable = compiler()
    if executable is None:
        wanted = " or ".join(COMPILERS)
        raise PoolError(f"there is no C++ compiler: install {wanted}, or name one by CXX")
    return executable


def _proved_or_failed(
    model: Model, trip: RoundTrip, settings: Settings, deadline: float
) -> MapResult:
    try:
        return _proved(model, trip, settings, deadline)
    except (ProgramError, WorkerError) as error:
        result = unproved(trip)
        result.error = str(error)
        result.remarks = [f"not proved: {result.error.partition(chr(10))[0]}"]
        return result
