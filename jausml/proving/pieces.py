"""Proofs of many maps: each is a piece of work for a pool."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.native import COMPILERS, compiler
from jausml.language.project import OneDocument, one_document
from jausml.live.workers.pool import Work
from jausml.live.workers.pool_processes import PoolError
from jausml.live.workers.worker import WorkerError
from jausml.proving.compiled_form import ProgramError
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove, unproved

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.model import Model
    from jausml.proving.results import MapResult
    from jausml.proving.round_trips import RoundTrip


@dataclass(frozen=True)
class _Shared:
    document: OneDocument
    settings: Settings
    until: float


class _Prover:
    """Proves the maps of a model, one after another."""

    def __init__(self, shared: _Shared) -> None:
        self._shared = shared
        self._model = shared.document.read().model
        self._trips = round_trips(self._model)

    def __call__(self, piece: tuple[str, int]) -> MapResult:
        name, number = piece
        trip = [each for each in self._trips if each.name == name][number]
        settings = replace(self._shared.settings, program=program())
        return _proved(self._model, trip, settings, self._shared.until)


def prove_all(
    model: Model, trips: Sequence[RoundTrip], settings: Settings, scheduler: str = ""
) -> Iterator[tuple[int, MapResult]]:
    """Yields the numbers of maps and what becomes of their values, in any order.

    Args:
        scheduler: Address of a scheduler of Dask, whose workers prove.

    Raises:
        PoolError: Nobody is there to prove them.
    """
    until = time.time() + settings.budget
    if not scheduler and min(settings.jobs, len(trips)) == 1:
        for number, each in enumerate(trips):
            yield number, _proved(model, each, settings, until)
        return
    threads = 1 if scheduler else max(1, settings.jobs // len(trips))
    shared = _Shared(one_document(model), replace(settings, jobs=threads), until)
    seen: Counter[str] = Counter()
    pieces = []
    for each in trips:
        pieces.append((each.name, seen[each.name]))
        seen[each.name] += 1
    yield from Work(_Prover, shared).results(pieces, settings.jobs, scheduler)


def program() -> str:
    """Returns the compiler of this machine.

    Raises:
        PoolError: There is none.
    """
    found = compiler()
    if found is None:
        wanted = " or ".join(COMPILERS)
        raise PoolError(f"there is no C++ compiler: install {wanted}, or name one by CXX")
    return found


def _proved(model: Model, trip: RoundTrip, settings: Settings, until: float) -> MapResult:
    settings = replace(settings, budget=max(0.0, until - time.time()))
    try:
        (found,) = prove(model, [trip], settings)
    except (ProgramError, WorkerError) as error:
        found = unproved(trip)
        found.error = str(error)
        found.remarks = [f"not proved: {found.error.partition(chr(10))[0]}"]
    return found
