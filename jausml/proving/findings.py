"""What proofs say: text for people, and findings where a proof falls short, with rules."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.model.rules import RuleInfo
from jausml.proving.layout import JAUS
from jausml.proving.round_trips import assignment_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from jausml.language.model import Model
    from jausml.language.validation.report import Report
    from jausml.proving.results import FieldResult, MapResult, Mixed
    from jausml.proving.round_trips import RoundTrip

_SHOWN = 8


def render(results: Iterable[MapResult]) -> str:
    """Returns a paragraph for each map and a line for each number."""
    return "\n".join(line for each in results for line in lines(each))


def lines(result: MapResult) -> Iterator[str]:
    """Yields the lines of a map."""
    yield f"{result.name}: {result.message} <-> {result.type}"
    for each in result.fields:
        yield f"  {each.side} {each.path}: {told(each)}"
    if result.not_carried:
        shown = ", ".join(result.not_carried[:_SHOWN])
        more = len(result.not_carried) - _SHOWN
        yield f"  not carried: {shown}" + (f", and {more} more" if more > 0 else "")
    for remark in result.remarks:
        yield f"  {remark}"


def told(each: FieldResult) -> str:
    """Returns what became of the values of a number."""
    return "; ".join([_values(each), *_parts(each)])


def _values(each: FieldResult) -> str:
    if each.is_complete:
        return f"all {each.total:,} values"
    return f"{each.tried:,} directed values of 2^{each.bits}"


def _parts(each: FieldResult) -> Iterator[str]:
    unit = unit_of(each)
    if not each.has_way_back:
        yield "one way"
        yield from _ways(each)
    elif each.is_constant:
        yield "always the same comes back"
    elif each.unchanged == each.tried:
        yield "unchanged"
    elif each.changed:
        yield f"{each.changed:,} change"
    if each.largest is not None:
        worst = each.largest
        between = "".join(f", {path} {value:.9g}" for path, value in worst.between.items())
        values = f"{worst.value:.9g}{unit}{between}, back {worst.back:.9g}{unit}"
        raw = f"raw {worst.raw}: " if each.step else ""
        yield f"largest error {worst.error:.6g}{unit} ({raw}{values})"
    if each.has_way_back and not each.is_constant and not each.is_monotonic:
        yield "not monotonic"
    yield from _treated(each)
    if each.drifting:
        drift, at = each.largest_drift
        text = f"{each.drifting:,} change again in a second trip"
        yield f"{text}, by up to {drift:.6g}{unit} (at {at:.9g}{unit})"
    if each.mixed is not None:
        yield _mixed(each.mixed, unit)
    if each.others:
        yield f"with {each.others:,} something else changes too"


def _mixed(mixed: Mixed, unit: str) -> str:
    text = f"with others at random {mixed.changed:,} of {mixed.tried:,} change"
    if mixed.changed:
        text += f", by up to {mixed.error:.6g}{unit} ({mixed.value:.9g}, back {mixed.back:.9g})"
    return f"{text}, {mixed.left:,} left to Python" if mixed.left else text


def _ways(each: FieldResult) -> Iterator[str]:
    for one in each.reached:
        way = f"{one.path} {one.least:.9g} .. {one.greatest:.9g}"
        if not one.is_monotonic:
            yield f"{way}, not monotonic"
        elif one.distinct < each.unchanged:
            yield f"{way}, {one.distinct:,} different values"
        else:
            yield way


def _treated(each: FieldResult) -> Iterator[str]:
    """What the Python form tells of the values that are left to it."""
    sampled = f" of {each.sampled} tried of {each.left:,}" if each.sampled else ""
    for count, what in (
        (each.limited, "limited"),
        (each.left_out, "left out"),
        (each.refused, "refused"),
        (sum(each.faults.values()), "fail"),
    ):
        if count:
            yield f"{count:,} {what}{sampled}"


def unit_of(each: FieldResult) -> str:
    """Returns the unit behind a blank; nothing where there is none."""
    return f" {each.units}" if each.units not in {"", "one", "1"} else ""


_PRECISION, _UNSTABLE, _MADE_UP, _FAULT, _FORMS = (f"JML{number}" for number in range(921, 926))

PROOF_RULES: Mapping[str, RuleInfo] = MappingProxyType(
    {
        _PRECISION: RuleInfo(
            "proof: error larger than the precision",
            "A value that went through a map and back differs by more than the `precision` of the "
            "assignment allows. Bad: `precision: 1e-7` for a float32 member of ROS that carries "
            "velocities in steps of 1.5e-7 m/s. Good: a float64 member, or the precision that is "
            "enough.",
        ),
        _UNSTABLE: RuleInfo(
            "proof: value that changes with each trip",
            "A value that has gone through a map and back once is changed again, by more than "
            "rounding explains, when it goes once more: the two directions differ, for example in "
            "a sign, a factor or an offset. Good: directions that undo each other.",
        ),
        _MADE_UP: RuleInfo(
            "proof: value that does not come back",
            "A field goes into the other message, and always the same comes back, whatever it was. "
            "The two directions read and write different members. Good: the other direction takes "
            "the value from where this one puts it.",
        ),
        _FAULT: RuleInfo(
            "proof: value that breaks a translation",
            "A translation ends with an error that no policy of the map foresees.",
        ),
        _FORMS: RuleInfo(
            "proof: forms of a translation that differ",
            "The compiled form of a translation and the one in Python make different messages of "
            "a value. Report this: both are made of the same steps.",
        ),
    }
)


def with_proofs(report: Report, trips: Sequence[RoundTrip], results: Sequence[MapResult]) -> Report:
    """Returns the report of a model with what falls short in proofs of it."""
    pairs = zip(trips, results, strict=True)
    found = [each for trip, one in pairs for each in _findings(report.model, trip, one)]
    diagnostics = sorted((*report.diagnostics, *found), key=lambda each: each.sort_key)
    return replace(report, diagnostics=tuple(diagnostics), rules=PROOF_RULES)


def by_map(report: Report) -> dict[str, list[str]]:
    """Returns what falls short in proofs, by name of the map."""
    found: dict[str, list[str]] = {}
    for each in report.diagnostics:
        if each.rule in PROOF_RULES:
            found.setdefault(each.element, []).append(f"{each.rule} {each.message}")
    return found


def _findings(model: Model, trip: RoundTrip, result: MapResult) -> Iterator[Diagnostic]:
    for each in result.fields:
        back = trip.to_jaus if each.side == JAUS else trip.to_ros
        place = assignment_of(trip, each.side, each.path) or back
        for rule, text in _faults(each):
            name = f"{trip.name}: {each.side} {each.path}"
            location = model.location(place)
            yield Diagnostic(rule, Severity.ERROR, location, f"{name} {text}", element=trip.name)


def _faults(each: FieldResult) -> Iterator[tuple[str, str]]:
    unit = unit_of(each)
    if each.largest is not None and 0 < each.precision < each.largest.error:
        text = f"comes back with an error of up to {each.largest.error:.6g}{unit}"
        text += f" (at {each.largest.value:.9g}), more than {each.precision:g}"
        yield _PRECISION, text
    if each.is_constant:
        yield _MADE_UP, "goes there, and always the same value comes back"
    elif 0 < each.tolerance < each.largest_drift[0]:
        drift, at = each.largest_drift
        yield _UNSTABLE, f"is changed by {drift:.6g}{unit} by a second trip (at {at:.9g}{unit})"
    for error, count in each.faults.items():
        yield _FAULT, f"ends with {error} ({count} values)"
    if each.differing:
        yield _FORMS, f"differs in its two forms with {each.differing} of {each.compared} values"
