"""Rules about ranges of numbers, and what happens out of them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from jausml.language.attributes import intervals
from jausml.language.attributes.intervals import Interval
from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.ranges import result_ranges, source_range
from jausml.language.semantics.assignments.units import (
    Measure,
    attribute_measure,
    measure,
    result_measure,
    units_clash,
)
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.attributes import (
    LARGEST_SINGLE,
    NUMBER,
    OCTETS,
    TEXT,
    Attribute,
    Found,
)
from jausml.language.semantics.paths.scopes import Direction, Placed, direction_of
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

# The runtime takes as much for the last bits of a conversion.
_ROUNDING = 2.0**-40
_SINGLE_BITS = 24
_GEODETIC = "geodetic"
_EARTH_RADIUS = 6378137.0
# A zero that is missed by less than this part of the range makes no difference to anyone.
_NEGLIGIBLE = 1e-6


@dataclass(frozen=True, slots=True)
class _End:
    """A numeric target of an assignment."""

    path: str
    attribute: Attribute
    carried: Interval
    given: Interval

    @property
    def slack(self) -> float:
        """How far beyond its range a number still becomes one of the range by rounding."""
        largest = max(
            (abs(number) for number in self.carried if math.isfinite(number)), default=0.0
        )
        return max(_ROUNDING * largest, (self.attribute.step or 0.0) / 2)


@rule(
    "JML434",
    "range of the source exceeds that of the target",
    severity=Severity.WARNING,
    kinds=Direction,
)
def exceeding_ranges(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """The target can carry all values of the source, or the assignment handles the others.

    Ranges are followed through the conversions, expressions included. Only what is bounded counts:
    integers, scaled JAUS fields, ROS fields with a stated range, angles, and what clamp leaves; a
    float64 may be anything and gives no finding. With its own `outOfRange`, the author has decided.

    Bad: `target="Cost" source="/data"` with the conversion scale(2), where occupancy is -1..100 and
    Cost carries 0..254

    Good: the same with the conversion occupancy_to_cost, or with `outOfRange="clamp"`
    """
    for placed, ends in _assignments(subject, direction):
        if placed.assignment.outOfRange.name != "asConnection":
            continue
        for end in ends:
            if not _is_apart(end) and _exceeds(end):
                message = f"'{placed.assignment.source}' may give {_text(end.given)},"
                message += f" but '{end.path}' carries {_text(end.carried)}"
                hint = "convert it, or say by outOfRange what becomes of the rest"
                yield Finding(placed.assignment, message, "target", hint)


@rule("JML435", "nothing that an assignment yields fits", kinds=Direction)
def impossible_ranges(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """At least one possible result of an assignment is a value that its target can carry.

    Bad: `target="Latitude"`, which carries -90..90, with the conversion clamp(100, 200)

    Good: clamp(-90, 90)
    """
    for placed, ends in _assignments(subject, direction):
        for end in ends:
            if intervals.is_empty(end.given):
                message = f"the conversions of '{placed.assignment.source}' never yield a number"
                yield Finding(placed.assignment, message, "source")
            elif _is_apart(end):
                message = f"'{placed.assignment.source}' gives {_text(end.given)},"
                message += f" nothing of which '{end.path}' carries ({_text(end.carried)})"
                yield Finding(placed.assignment, message, "target")


@rule("JML436", "precision is lost", severity=Severity.WARNING, kinds=Direction)
def precision_loss(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """Rounding in the target keeps within the `precision` that an assignment states.

    An integer is rounded to 1, a scaled JAUS field of n bits to its range / (2^n - 1), a float32 to
    24 bits of its largest value. Without a stated precision three losses are reported: a target
    that makes one number of all values, a latitude or longitude in a float32, which moves a
    position on the ground, and a quantity with a unit that becomes a ROS integer. Whoever accepts
    one of them states it as the precision.

    Bad: `target="Yaw" precision="1e-5"`, where Yaw has 16 bits for 2 pi: steps of 9.6e-5 radian;
    `target="longitude" source="Longitude"`, where longitude is a float32: off by 0.85 m

    Good: `precision="1e-4"`; a float64
    """
    for placed, ends in _assignments(subject, direction):
        precision = placed.assignment.precision
        if not (math.isfinite(precision) and precision >= 0):
            message = f"precision {precision:g} of '{placed.assignment.target}' is no distance"
            yield Finding(placed.assignment, message, "precision", severity=Severity.ERROR)
            continue
        for end in ends:
            error = _rounding_error(placed, end)
            if 0 < precision < error:
                message = f"'{end.path}' is off by up to {error:.3g} from rounding,"
                message += f" more than the precision of {precision:g}"
                yield Finding(placed.assignment, message, "precision")
            elif error and _is_flattened(end):
                message = f"'{placed.assignment.source}' gives {_text(end.given)},"
                message += f" all of which '{end.path}' rounds to one number"
                yield Finding(placed.assignment, message, "target", "scale it")
            elif error and not precision and (loss := _silent_loss(placed, end, error)):
                message = f"'{end.path}' is off by up to {loss} from rounding"
                hint = "take a float64, or state the precision that is enough"
                yield Finding(placed.assignment, message, "target", hint)


@rule("JML439", "zero that cannot be sent", severity=Severity.INFO, kinds=Direction)
def missed_zeros(_: Subject, direction: Direction) -> Iterator[Finding]:
    """A constant 0 goes to a field that has a zero, or the author knows that it has none.

    A scaled field with a range such as -100..100 has an even number of steps, none of which is 0:
    the value sent is half a step off, so a receiver that acts on every value except 0 acts. The
    receiver should have a dead band. A documentation of the assignment silences the rule. The rule
    ignores the stop of a map, which has no better value.

    Bad: `<safeValue target="PropulsiveLinearEffortX" value="0"/>`

    Good: the same with `documentation="0.0015 % is sent, which the dead band of the motor hides"`
    """
    if isinstance(direction.owner, bridge.Stop):
        return
    for placed in direction.of_kind(bridge.ConstantAssignment):
        for path, target in placed.targets:
            sent = _sent_for_zero(placed.assignment.value, target)
            if sent and not placed.assignment.documentation:
                message = f"0 for '{path}' is sent as {sent:.3g}"
                hint = "the field has no zero; the receiver needs a dead band"
                yield Finding(placed.assignment, message, "value", hint)


def _assignments(
    subject: Subject, direction: Direction
) -> list[tuple[Placed[bridge.FieldAssignment], list[_End]]]:
    return subject.once(_find_assignments, direction)


def _find_assignments(
    _: Subject, direction: Direction
) -> list[tuple[Placed[bridge.FieldAssignment], list[_End]]]:
    return [
        (placed, _ends(placed))
        for placed in direction.of_kind(bridge.FieldAssignment)
        if placed.source_attributes and placed.target_attributes and not units_clash(placed)
    ]


def _ends(placed: Placed[bridge.FieldAssignment]) -> list[_End]:
    if not any(target_attribute.kind == NUMBER for target_attribute in placed.target_attributes):
        return []
    ranges = result_ranges(placed)
    if len(ranges) != len(placed.targets):
        return []
    number_ends = []
    ends = zip(placed.targets, placed.target_attributes, ranges, strict=True)
    for (path, _), attribute, values in ends:
        carried = source_range(attribute) if attribute.kind == NUMBER else None
        # Listed values have rules of their own.
        if carried is not None and not attribute.named:
            number_ends.append(_End(path, attribute, carried, values))
    return number_ends


def _exceeds(end: _End) -> bool:
    low = end.given[0] < end.carried[0] - end.slack and math.isfinite(end.given[0])
    high = end.given[1] > end.carried[1] + end.slack and math.isfinite(end.given[1])
    return low or high


def _is_apart(end: _End) -> bool:
    if intervals.is_empty(end.given):
        return True
    below = end.given[1] < end.carried[0] - end.slack
    return below or end.given[0] > end.carried[1] + end.slack


def _rounding_error(placed: Placed[bridge.FieldAssignment], end: _End) -> float:
    """The greatest distance between a number and what the target makes of it."""
    sources = placed.source_attributes
    is_copied = not placed.assignment.conversions and sources[0].integral
    if end.attribute.step is not None:
        if is_copied and end.attribute.integral:
            return 0.0
        # A field that cuts numbers off is wrong by a whole step, one that rounds by half of it.
        return end.attribute.step / (1 if _is_cut(end.attribute) else 2)
    if not end.attribute.is_single:
        return 0.0
    largest = max(map(abs, intervals.meet(end.given, end.carried)))
    if not 0.0 < largest < LARGEST_SINGLE:
        return 0.0
    # Half of the last of the 24 bits of the largest value.
    return math.ldexp(0.5, math.frexp(largest)[1] - _SINGLE_BITS)


def _silent_loss(placed: Placed[bridge.FieldAssignment], end: _End, error: float) -> str:
    """Returns the loss by rounding of a position or a quantity, in words; empty for a harmless one.

    Args:
        error: What rounding loses, in the unit of the target.
    """
    end_measure = attribute_measure(end.attribute) or result_measure(placed)
    if not isinstance(end_measure, Measure) or not end.attribute.is_ros:
        return ""
    ends = (end.attribute, *placed.source_attributes)
    angle = measure("rad")
    if end.attribute.is_single and angle is not None and end_measure.unit.is_compatible(angle.unit):
        if any(attribute.frame == _GEODETIC for attribute in ends):
            return f"{error * end_measure.unit.factor * _EARTH_RADIUS:.2g} m on the ground"
    elif end.attribute.integral and not any(source.integral for source in placed.source_attributes):
        return f"{error:g} {end_measure.text}" if end_measure.unit.dimension else ""
    return ""


def _is_cut(attribute: Attribute) -> bool:
    scale = getattr(attribute.field, "scale", None)
    return scale is not None and scale.rounding.name != "round"


def _is_flattened(end: _End) -> bool:
    """Whether all values become one number, although they differ."""
    step = end.attribute.step
    values = intervals.meet(end.given, end.carried)
    if not step or not all(map(math.isfinite, values)) or _is_cut(end.attribute):
        return False
    # Scaled fields count their steps from the lower end.
    origin = 0.0 if end.attribute.integral else end.carried[0]
    low, high = (round((value - origin) / step) for value in values)
    return values[0] < values[1] and low == high


def _sent_for_zero(value: str, target: Found) -> float:
    """Returns the value that a scaled field sends for a constant zero; 0 where it has a zero."""
    if not isinstance(target, Attribute) or target.integral or not target.step:
        return 0.0
    lower, step = target.lower or 0.0, target.step
    try:
        is_zero = float(value) == 0.0
    except ValueError:
        return 0.0
    sent = lower + round(-lower / step) * step
    largest = max(abs(lower), abs(target.upper or 0.0))
    return sent if is_zero and abs(sent) > _NEGLIGIBLE * largest else 0.0


def _text(values: Interval) -> str:
    low, high = (f"{value:.6g}" for value in values)
    return low if low == high else f"{low}..{high}"


_DROP_FIELD = "dropField"
_HINT = "clamp, dropMessage or error"
_LIMITED = (NUMBER, TEXT, OCTETS)
_MOST_NOTES = 3


@rule("JML417", "field that cannot be left out", kinds=Direction)
def left_out_fields(_: Subject, direction: Direction) -> Iterator[Finding]:
    """The policy dropField is for optional fields of JAUS messages.

    A JAUS message always has its other fields, and a ROS message has all of its fields: instead of
    being left out, they would carry a number that nobody measured. The policy of a connection
    applies to the assignments of its direction that state none.

    Bad: `outOfRange="dropField"` with `target="Speed"` of SetTravelSpeed, which has no optional
    field

    Good: the same with `outOfRange="dropMessage"`
    """
    for placed in direction.of_kind(bridge.FieldAssignment):
        if placed.assignment.outOfRange.name != _DROP_FIELD:
            continue
        path = _never_left_out(placed)
        if path is not None:
            message = f"'{path}' is no optional JAUS field, it is never left out"
            yield Finding(placed.assignment, message, "outOfRange", _HINT)


@left_out_fields.also(bridge.Connection)
def _left_out_fields_connection(
    subject: Subject, connection: bridge.Connection
) -> Iterator[Finding]:
    if connection.outOfRange.name == _DROP_FIELD and connection.map is not None:
        yield from _connection_findings(subject, connection)


@rule("JML418", "values that cannot be clamped", severity=Severity.WARNING, kinds=Direction)
def clamped_values(_: Subject, direction: Direction) -> Iterator[Finding]:
    """The policy clamp is for numbers; values that have names each mean something else.

    The value next to an unknown one is no better than any other, and a text that is cut has another
    meaning. Such a message is dropped and counted, which an assignment that states clamp itself
    does not expect. The policy of a connection may be clamp, because it applies to the numbers.

    Bad: `outOfRange="clamp"` with a target whose value set lists CLOSED and OPEN

    Good: the same with `outOfRange="dropMessage"`
    """
    if direction.to_ros:
        return
    for placed in direction.of_kind(bridge.FieldAssignment):
        if placed.assignment.outOfRange.name != "clamp":
            continue
        for path, target in placed.targets:
            message = _unclampable(path, target)
            if message:
                hint = "dropField, dropMessage or error"
                yield Finding(placed.assignment, message, "outOfRange", hint)


def _unclampable(path: str, target: Found) -> str:
    if not isinstance(target, Attribute):
        return ""
    if target.named:
        return f"the values of '{path}' have names, none is nearest"
    if target.kind in (TEXT, OCTETS):
        return f"'{path}' is {target.name}, which is never cut"
    return ""


def _never_left_out(placed: Placed[bridge.FieldAssignment]) -> str | None:
    """The first target that is there in any case, None when all may be left out."""
    for path, target in placed.targets:
        if placed.scope.to_ros:
            return path
        if isinstance(target, Attribute) and target.kind in _LIMITED and not target.optional:
            return path
    return None


def _connection_findings(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    to_ros = is_to_ros(connection)
    if to_ros:
        message = f"'{connection.name}' makes ROS messages, whose fields are never left out"
        yield Finding(connection, message, "outOfRange", _HINT)
        return
    direction = direction_of(subject, connection.map, to_ros=False)
    if direction is None:
        return
    assignments = [
        placed.assignment
        for placed in direction.of_kind(bridge.FieldAssignment)
        if placed.assignment.outOfRange.name == "asConnection"
        and _never_left_out(placed) is not None
    ]
    if assignments:
        names = ", ".join(f"'{assignment.target}'" for assignment in assignments[:_MOST_NOTES])
        more = " ..." if len(assignments) > _MOST_NOTES else ""
        message = f"'{connection.name}' leaves out fields that are not optional: {names}{more}"
        notes = tuple(
            Note(assignment, f"'{assignment.target}'", "target")
            for assignment in assignments[:_MOST_NOTES]
        )
        hint = f"give these assignments {_HINT}"
        yield Finding(connection, message, "outOfRange", hint, notes)
