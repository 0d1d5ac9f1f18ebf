"""Results of proofs: of each number of a map, as text, and as findings with rules."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from jausml.language.model import Model
from jausml.language.model.diagnostics import Diagnostic, RuleInfo, Severity
from jausml.language.validation.rule import Report
from jausml.proving.layout import JAUS
from jausml.proving.round_trips import RoundTrip, assignment_of


@dataclass(frozen=True)
class Extreme:
    """The value with the largest error (`between`: the values of the other message, by path)."""

    error: float
    raw: int
    value: float
    between: Mapping[str, float]
    back: float


@dataclass(frozen=True)
class Mixed:
    """The outcome for values while the numbers that share their member are random."""

    tried: int
    unchanged: int
    changed: int
    left: int
    error: float
    value: float
    back: float


@dataclass(frozen=True)
class Reached:
    """A number of the other message that depends on the values.

    Attributes:
        distinct: How many different values it takes, where it goes in one direction.
    """

    path: str
    least: float
    greatest: float
    is_monotonic: bool
    distinct: int


@dataclass
class FieldResult:
    """The outcome for the values of a number.

    Attributes:
        total: How many values the wire can bring.
        step: Difference between neighbouring values; 0 for floating point.
        drifting: How many are changed again by a second trip.
        largest_drift: The largest change by a second trip, and the value at which it is.
        others: With how many values something else in the message has changed.
        is_constant: Whether always the same comes back, by an assignment of its own or a constant.
        limited: How many values were cut off, as the Python form tells.
        computed: How many of those that are left to Python come back as others do.
        faults: Errors that no bridge expects, with how many values have them.
        reasons: Why values are limited, left out or refused, with how many.
        sampled: Of how many values all that the Python form tells is; 0 for all of them.
        bins: The largest error in each part of the range.
        precision: The largest error that the model allows; 0 where it states none.
        needs: Seconds that all values would take, where they can be tried and were not.
        tolerance: The largest change by a second trip that rounding explains; 0 where nobody knows.
        mixed: The same with random values of others; None where it shares no member with them.
    """

    side: str
    path: str
    units: str
    bits: int
    step: float
    ends: tuple[float, float]
    total: int
    tried: int = 0
    has_way_back: bool = False
    unchanged: int = 0
    changed: int = 0
    largest: Extreme | None = None
    drifting: int = 0
    largest_drift: tuple[float, float] = (0.0, 0.0)
    others: int = 0
    is_monotonic: bool = True
    is_constant: bool = False
    reached: list[Reached] = field(default_factory=list)
    limited: int = 0
    left_out: int = 0
    refused: int = 0
    computed: int = 0
    faults: dict[str, int] = field(default_factory=dict)
    reasons: dict[str, int] = field(default_factory=dict)
    left: int = 0
    sampled: int = 0
    compared: int = 0
    differing: int = 0
    bins: list[float] = field(default_factory=list)
    precision: float = 0.0

    needs: float = 0.0
    tolerance: float = 0.0
    mixed: Mixed | None = None

    @property
    def is_complete(self) -> bool:
        """Whether all values were tried."""
        return self.tried == self.total


@dataclass
class MapResult:
    """The outcome for the values of a map.

    Attributes:
        error: Why it could not be proved, which is no fault of the map; empty where it was.
    """

    name: str
    message: str
    type: str
    fields: list[FieldResult] = field(default_factory=list)
    not_carried: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    seconds: float = 0.0
    error: str = ""

    def find(self, side: str, path: str) -> FieldResult | None:
        """Returns the result for a number; None where there is none."""
        fields = self.fields
        return next(
            (result for result in fields if (result.side, result.path) == (side, path)), None
        )

    def to_json(self) -> dict[str, Any]:
        """Returns the result as JSON."""
        return asdict(self)


_SHOWN = 8


def render(results: Iterable[MapResult]) -> str:
    """Returns a paragraph for each map and a line for each number."""
    return "\n".join(line for result in results for line in lines(result))


def lines(result: MapResult) -> Iterator[str]:
    """Yields the lines of a map."""
    yield f"{result.name}: {result.message} <-> {result.type}"
    for field_result in result.fields:
        yield f"  {field_result.side} {field_result.path}: {outcome_text(field_result)}"
    if result.not_carried:
        shown = ", ".join(result.not_carried[:_SHOWN])
        more = len(result.not_carried) - _SHOWN
        yield f"  not carried: {shown}" + (f", and {more} more" if more > 0 else "")
    for remark in result.remarks:
        yield f"  {remark}"


def outcome_text(result: FieldResult) -> str:
    """Returns the outcome for the values of a number, in words."""
    return "; ".join([_values(result), *_parts(result)])


def _values(result: FieldResult) -> str:
    if result.is_complete:
        return f"all {result.total:,} values"
    return f"{result.tried:,} directed values of 2^{result.bits}"


def _parts(result: FieldResult) -> Iterator[str]:
    unit = unit_of(result)
    if not result.has_way_back:
        yield "one way"
        yield from _directions(result)
    elif result.is_constant:
        yield "always the same comes back"
    elif result.unchanged == result.tried:
        yield "unchanged"
    elif result.changed:
        yield f"{result.changed:,} change"
    if result.largest is not None:
        worst = result.largest
        between = "".join(f", {path} {value:.9g}" for path, value in worst.between.items())
        values = f"{worst.value:.9g}{unit}{between}, back {worst.back:.9g}{unit}"
        raw = f"raw {worst.raw}: " if result.step else ""
        yield f"largest error {worst.error:.6g}{unit} ({raw}{values})"
    if result.has_way_back and not result.is_constant and not result.is_monotonic:
        yield "not monotonic"
    yield from _treated(result)
    if result.drifting:
        drift, at = result.largest_drift
        text = f"{result.drifting:,} change again in a second trip"
        yield f"{text}, by up to {drift:.6g}{unit} (at {at:.9g}{unit})"
    if result.mixed is not None:
        yield _mixed(result.mixed, unit)
    if result.others:
        yield f"with {result.others:,} something else changes too"


def _mixed(mixed: Mixed, unit: str) -> str:
    text = f"with others at random {mixed.changed:,} of {mixed.tried:,} change"
    if mixed.changed:
        text += f", by up to {mixed.error:.6g}{unit} ({mixed.value:.9g}, back {mixed.back:.9g})"
    return f"{text}, {mixed.left:,} left to Python" if mixed.left else text


def _directions(result: FieldResult) -> Iterator[str]:
    for reached in result.reached:
        way = f"{reached.path} {reached.least:.9g} .. {reached.greatest:.9g}"
        if not reached.is_monotonic:
            yield f"{way}, not monotonic"
        elif reached.distinct < result.unchanged:
            yield f"{way}, {reached.distinct:,} different values"
        else:
            yield way


def _treated(result: FieldResult) -> Iterator[str]:
    """Yields the reports of the Python form on the values that are left to it."""
    sampled = f" of {result.sampled} tried of {result.left:,}" if result.sampled else ""
    for count, what in (
        (result.limited, "limited"),
        (result.left_out, "left out"),
        (result.refused, "refused"),
        (sum(result.faults.values()), "fail"),
    ):
        if count:
            yield f"{count:,} {what}{sampled}"


def unit_of(result: FieldResult) -> str:
    """Returns the unit behind a blank; nothing where there is none."""
    return f" {result.units}" if result.units not in {"", "one", "1"} else ""


_PRECISION, _UNSTABLE, _MADE_UP, _FAULT, _FORMS = (f"JML{number}" for number in range(921, 926))

PROOF_RULES: Mapping[str, RuleInfo] = {
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
        "The two directions read and write different members, or one sends a constant. Good: "
        "the other direction takes the value from where this one puts it.",
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


def with_proofs(report: Report, trips: Sequence[RoundTrip], results: Sequence[MapResult]) -> Report:
    """Returns the report of a model with the shortcomings found by proofs."""
    proof_diagnostics = [
        finding.diagnostic(report.model, trip)
        for trip, result in zip(trips, results, strict=True)
        for finding in findings(trip, result)
    ]
    diagnostics = sorted(
        (*report.diagnostics, *proof_diagnostics), key=lambda diagnostic: diagnostic.sort_key
    )
    return replace(report, diagnostics=tuple(diagnostics), rules=PROOF_RULES)


def by_map(report: Report) -> dict[str, list[str]]:
    """Returns the shortcomings that proofs have found, by name of the map."""
    findings_by_map: dict[str, list[str]] = {}
    for diagnostic in report.diagnostics:
        if diagnostic.rule in PROOF_RULES:
            findings_by_map.setdefault(diagnostic.element, []).append(
                f"{diagnostic.rule} {diagnostic.message}"
            )
    return findings_by_map


@dataclass(frozen=True)
class ProofFinding:
    """A shortcoming in the proof of a number (`side`, `path`: as in its `FieldResult`)."""

    rule: str
    side: str
    path: str
    message: str

    def diagnostic(self, model: Model, trip: RoundTrip) -> Diagnostic:
        """Returns the finding at the assignment by which the number comes back, or at the map."""
        back = trip.to_jaus if self.side == JAUS else trip.to_ros
        location = model.location(assignment_of(trip, self.side, self.path) or back)
        return Diagnostic(self.rule, Severity.ERROR, location, self.message, element=trip.name)


def findings(trip: RoundTrip, result: MapResult) -> Iterator[ProofFinding]:
    """Yields the shortcomings in the proof of a map."""
    for field_result in result.fields:
        side, path = field_result.side, field_result.path
        for rule, text in _faults(field_result):
            yield ProofFinding(rule, side, path, f"{trip.name}: {side} {path} {text}")


def _faults(result: FieldResult) -> Iterator[tuple[str, str]]:
    unit = unit_of(result)
    if result.largest is not None and 0 < result.precision < result.largest.error:
        text = f"comes back with an error of up to {result.largest.error:.6g}{unit}"
        text += f" (at {result.largest.value:.9g}), more than {result.precision:g}"
        yield _PRECISION, text
    if result.is_constant:
        yield _MADE_UP, "goes there, and always the same value comes back"
    elif 0 < result.tolerance < result.largest_drift[0]:
        drift, at = result.largest_drift
        yield _UNSTABLE, f"is changed by {drift:.6g}{unit} by a second trip (at {at:.9g}{unit})"
    for error, count in result.faults.items():
        yield _FAULT, f"ends with {error} ({count} values)"
    if result.differing:
        yield (
            _FORMS,
            f"differs in its two forms with {result.differing} of {result.compared} values",
        )
