"""Runs of proofs: all values of narrow numbers, and those of wide ones as far as the time goes."""

from __future__ import annotations

import os
import tempfile
import time
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.proving.compiled_form import CompiledForm, Tally, compiled
from jausml.proving.known import Known
from jausml.proving.plan import plan
from jausml.proving.proof_bridge import NAME, proof_code
from jausml.proving.python_form import PythonForm
from jausml.proving.results import MapResult
from jausml.proving.summary import EXAMPLES, Swept, summed_up
from jausml.proving.values import directed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.model import Model
    from jausml.proving.plan import Field
    from jausml.proving.round_trips import RoundTrip

NARROW = 16
"""Bits of numbers of which all values are tried in whole messages."""

WIDEST = 32
"""Bits of the widest numbers of which all values may be tried."""

_DIRECTED, _DIRECTED_OF_MORE = 1 << 16, 1 << 14
"""How many values are tried of wide numbers, and of those of which there is no trying all."""

_TRIED = 1 << 18
"""Values by which it is found out how long all would take."""


@dataclass(frozen=True)
class Settings:
    """How proofs run.

    Attributes:
        program: The compiler.
        budget: Seconds for all values of numbers of more than 16 bits, where they can be tried.
        jobs: How many processors work at once.
        is_cached: Whether what was proved before counts.
    """

    program: str
    budget: float
    jobs: int
    is_cached: bool = False


def prove(model: Model, trips: Iterable[RoundTrip], settings: Settings) -> Iterator[MapResult]:
    """Yields what becomes of the values of maps.

    Raises:
        ProgramError: The compiler refuses the program of a map, or it ends.
        WorkerError: The process of the Python form ends.
    """
    deadline = time.monotonic() + settings.budget
    for each in trips:
        yield _proved(model, each, settings, deadline)


def unproved(trip: RoundTrip) -> MapResult:
    """Returns the result of a map of which nothing is known yet."""
    return MapResult(trip.name, str(trip.to_ros.message.name), str(trip.to_ros.type.name))


def _proved(model: Model, trip: RoundTrip, settings: Settings, deadline: float) -> MapResult:
    begun = time.monotonic()
    code = proof_code(model, trip)
    place = Known(code, trip) if settings.is_cached else None
    known = place.load() if place is not None else None
    if known is not None and not known.would_gain(deadline - begun):
        return known
    made = unproved(trip)
    if not code.directions:
        made.remarks = [f"left to Python: {each}" for each in code.reasons]
        return made
    with (
        tempfile.TemporaryDirectory(prefix="jausml_proof_") as folder,
        CompiledForm(compiled(code, Path(folder), settings.program)) as form,
        closing(PythonForm(code.python, NAME)) as python,
    ):
        planned = plan(code, form, trip)
        made.not_carried, made.remarks = planned.not_carried, planned.remarks
        for each in planned.fields:
            before = known.find(each.side, each.path) if known is not None else None
            if before is None or before.needs:
                found = _swept(form, each, settings.jobs, deadline)
                before = summed_up(trip, each, found, python, form)
            made.fields.append(before)
    made.seconds = time.monotonic() - begun
    if place is not None:
        place.store(made)
    return made


def _swept(form: CompiledForm, planned: Field, jobs: int, deadline: float) -> Swept:
    """Returns what becomes of the values of a number."""
    sweep, bits = planned.sweep, planned.number.bits
    total = 1 << bits
    count = _DIRECTED if bits <= WIDEST else _DIRECTED_OF_MORE
    indices = range(total) if bits <= NARROW else directed(planned.number, count)
    most = total if bits <= NARROW else EXAMPLES
    found = Swept(form.run(sweep, indices, most, jobs))
    if planned.partners:
        mixed = replace(sweep, varied=planned.partners)
        found = replace(found, mixed=form.run(mixed, indices, most, jobs))
    if not NARROW < bits <= WIDEST:
        return found
    if planned.shortcut:
        short = replace(sweep, shortcut=planned.shortcut)
        if _is_alike(found.tally, form.run(short, indices, most, jobs)):
            sweep = short
    begun = time.monotonic()
    form.run(sweep, range(total // 2, total // 2 + _TRIED), most)
    seconds = (time.monotonic() - begun) * total / _TRIED / jobs
    if seconds > deadline - time.monotonic():
        return replace(found, needs=seconds)
    return replace(found, wide=form.run(sweep, range(total), most, jobs))


def _is_alike(whole: Tally, short: Tally) -> bool:
    """Whether a sweep without the rest of the message finds what one of whole messages does."""
    counts = ("count", "unchanged", "changed", "others", "left_out", "left", "drifting")
    names = (*counts, "largest", "largest_drift")
    return all(getattr(whole, each) == getattr(short, each) for each in names)


def processors() -> int:
    """Returns how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
