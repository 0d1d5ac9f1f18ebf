"""Summaries of proofs: what became of the values of a number in both forms, and extremes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from jausml.proving.compiled_form import CompiledForm, PythonForm, Tally, Trip
from jausml.proving.layout import FLOAT, JAUS, Number
from jausml.proving.plan import Field
from jausml.proving.positions import spread_positions
from jausml.proving.results import (
    Extreme,
    FieldResult,
    Mixed,
    Reached,
)
from jausml.proving.round_trips import RoundTrip, assignment_of, is_alone, is_held

_COMPARED = 300  # how many values go through both forms, besides those that Python alone treats

EXAMPLES = 64
"""Of how many values of wide numbers the Python form tells what it does with them."""

# A value that is rounded twice may come back as a neighbour, and computes to a bit more than that.
_STEPS = 1.5
_SINGLE = 2.0**-23  # part of a number by which its neighbour in single precision differs

_CLAMP = "clamp "


@dataclass(frozen=True)
class Swept:
    """The outcome for the values of a number by its compiled form.

    Attributes:
        wide: What becomes of all values, where the time was enough for more than those above.
        needs: Seconds that these would take, where it was not.
        mixed: What becomes of the values while others that share a member with them are random.
    """

    tally: Tally
    wide: Tally | None = None
    needs: float = 0.0
    mixed: Tally | None = None


def summed_up(
    trip: RoundTrip, planned: Field, sweep_result: Swept, python: PythonForm, form: CompiledForm
) -> FieldResult:
    """Returns the result for the values of a number of a map.

    Both forms run again: Python takes the values around that the compiled form leaves to it, and
    some go through both, which have to agree.

    Raises:
        ProgramError: The program of the compiled form has ended.
    """
    number, tally = planned.number, sweep_result.wide or sweep_result.tally
    assignment = assignment_of(trip, planned.side, planned.path)
    is_constant = tally.result.seen > 1 and not (tally.result.rises or tally.result.falls)
    # A status or mode may be held; a quantity that was carried there is lost.
    is_lost = bool(planned.units) and is_held(trip, planned.side, planned.path)
    result = FieldResult(
        side=planned.side,
        path=planned.path,
        units=planned.units,
        bits=number.bits,
        step=0.0 if number.kind == FLOAT else number.step,
        ends=number.ends,
        total=1 << number.bits,
        tried=tally.count,
        has_way_back=planned.sweep.has_back,
        unchanged=tally.unchanged,
        changed=tally.changed,
        largest=_largest(planned, tally, form),
        drifting=tally.drifting,
        largest_drift=(tally.largest_drift, number.value(number.raw(tally.drift_at))),
        tolerance=_tolerance(planned),
        others=tally.others,
        is_monotonic=not (tally.result.rises and tally.result.falls),
        is_constant=is_constant and (is_lost or is_alone(assignment, planned.path)),
        reached=_reached(planned, sweep_result.tally),
        left_out=tally.left_out,
        left=tally.left,
        bins=tally.bins if tally.largest else [],
        needs=sweep_result.needs,
        mixed=None if sweep_result.mixed is None else _mixed(number, sweep_result.mixed),
    )
    if assignment is not None and planned.side == JAUS:
        result.precision = float(assignment.precision)
    _classify(result, planned, tally.examples, python)
    _compare(result, planned, python, form)
    return result


def _largest(planned: Field, tally: Tally, form: CompiledForm) -> Extreme | None:
    if not tally.largest:
        return None
    number, sweep = planned.number, planned.sweep
    raw = number.raw(tally.largest_at)
    between = form.translate(number.put(sweep.message, raw), to_ros=sweep.to_ros) or b""
    is_alike = len(between) == sweep.between
    values = {
        watched.path: watched.value(watched.read(between)) for watched in sweep.watched if is_alike
    }
    back = number.value(tally.largest_back)
    return Extreme(tally.largest, raw, number.value(raw), values, back)


def _tolerance(planned: Field) -> float:
    """The resolution of a number, or that of single precision if it goes through that."""
    number = planned.number
    if number.kind == FLOAT:
        return 0.0
    coarse = max(map(abs, number.ends)) * _SINGLE
    is_single = any(watched.kind == FLOAT and watched.size == 4 for watched in planned.watched)
    return max(_STEPS * number.step, coarse if is_single else 0.0)


def _mixed(number: Number, tally: Tally) -> Mixed:
    value, back = number.value(number.raw(tally.largest_at)), number.value(tally.largest_back)
    counts = tally.count, tally.unchanged, tally.changed, tally.left
    return Mixed(*counts, tally.largest, value, back)


def _reached(planned: Field, tally: Tally) -> list[Reached]:
    reached_numbers = []
    for number, course in zip(planned.watched, tally.watched, strict=True):
        is_monotonic = not (course.rises and course.falls)
        distinct = course.rises + course.falls + 1 if is_monotonic and course.seen else 0
        ends = course.least, course.greatest
        reached_numbers.append(Reached(number.path, *ends, is_monotonic, distinct))
    return reached_numbers


def _messages(planned: Field, indices: Sequence[int]) -> list[bytes]:
    number, message = planned.number, planned.sweep.message
    return [number.put(message, number.raw(index)) for index in indices]


def _trips(planned: Field, indices: Sequence[int], python: PythonForm) -> list[Trip]:
    sweep, messages = planned.sweep, _messages(planned, indices)
    return python.trips(messages, sweep.joins_back, to_ros=sweep.to_ros, has_back=sweep.has_back)


def _classify(
    result: FieldResult, planned: Field, indices: Sequence[int], python: PythonForm
) -> None:
    """Classifies the values that the compiled form leaves to the Python form."""
    faults: Counter[str] = Counter()
    reasons: Counter[str] = Counter()
    for index, trip in zip(indices, _trips(planned, indices, python), strict=True):
        made_last = trip.back if result.has_way_back else trip.between
        if trip.error and not trip.is_refused:
            faults[trip.error] += 1
        elif trip.error or made_last is None:
            result.refused += 1
            reasons[trip.error.partition(":")[0] or "dropped"] += 1
        elif any(note.startswith(_CLAMP) for note in trip.notes):
            result.limited += 1
            reasons[trip.notes[0]] += 1
        elif trip.notes:
            result.left_out += 1
            reasons[trip.notes[0]] += 1
        else:
            _count(result, planned, index, made_last)
    result.faults, result.reasons = dict(faults), dict(reasons)
    result.sampled = len(indices) if len(indices) < result.left else 0


def _count(result: FieldResult, planned: Field, index: int, last: bytes) -> None:
    """Counts a value that Python takes around as it is."""
    result.computed += 1
    number = planned.number
    raw = number.raw(index)
    if not result.has_way_back:
        result.unchanged += 1
    elif len(last) != planned.sweep.size:
        result.left_out += 1
    else:
        back = number.read(last)
        error = _distance(planned, raw, back)
        if error:
            result.changed += 1
        else:
            result.unchanged += 1
        if error > (0.0 if result.largest is None else result.largest.error):
            result.largest = Extreme(error, raw, number.value(raw), {}, number.value(back))


def _distance(planned: Field, raw: int, back: int) -> float:
    """How far two values are apart, as the program has it."""
    first, second = planned.number.value(raw), planned.number.value(back)
    if first == second or (math.isnan(first) and math.isnan(second)):
        return 0.0
    distance, turn = abs(first - second), planned.sweep.turn
    if math.isnan(distance):
        return math.inf
    return min(distance, abs(turn - distance)) if turn else distance


def _compare(result: FieldResult, planned: Field, python: PythonForm, form: CompiledForm) -> None:
    """Puts some values through both forms."""
    sweep = planned.sweep
    number = planned.number
    # What NaN looks like inside is no matter of either form.
    indices = [
        position
        for position in spread_positions(number, _COMPARED)
        if not math.isnan(number.value(number.raw(position)))
    ]
    messages = _messages(planned, indices)
    for message, trip in zip(messages, _trips(planned, indices, python), strict=True):
        between = form.translate(message, to_ros=sweep.to_ros)
        if between is None:
            continue
        back = None
        if sweep.has_back:
            back = form.translate(between + sweep.joins_back, to_ros=not sweep.to_ros)
        result.compared += 1
        if between != trip.between or back not in (None, trip.back):
            result.differing += 1
