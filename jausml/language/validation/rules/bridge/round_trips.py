"""Rules about both directions of a map together, and about variances."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.ranges import sent_through, source_range
from jausml.language.semantics.assignments.units import units_clash
from jausml.language.semantics.conversions import Effect, NoValueError, UnitEffect, conversion_of
from jausml.language.semantics.conversions.numbers import Square, SquareRoot
from jausml.language.semantics.paths.attributes import NUMBER, Attribute, Found
from jausml.language.semantics.paths.scopes import Direction, Placed, directions_of
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

# Where a field has no range, numbers of everyday size tell a wrong factor or sign.
_SAMPLES = (-100.0, -1.5, -0.25, 0.0, 0.25, 1.0, 100.0)
_PARTS = (0.0, 0.125, 0.25, 0.5, 0.6, 0.75, 0.9, 1.0)
_EXACT = 1e-9
# Two roundings to single precision.
_SINGLE = 2.0**-23
_CELL = re.compile(r"(.*)\[([0-9]+)\]", re.DOTALL)
_MATRICES = {9: 3, 36: 6}


@rule(
    "JML437",
    "round trip that does not come back",
    severity=Severity.WARNING,
    kinds=bridge.AttributeMap,
)
def round_trips(subject: Subject, directed: bridge.AttributeMap) -> Iterator[Finding]:
    """If a map has both directions, a value that goes from JAUS to ROS comes back unchanged.

    A field that becomes a ROS attribute from which a field is made is this field, and its numbers
    differ by one step of the field at most. The round trip is computed for numbers over the whole
    range, through units, tables and expressions; intended changes by clamp or deadband do not
    count.

    Bad: `RollRate -> angular.x` and back `angular.x -> PitchRate`

    Good: `RollRate -> angular.x` and back `angular.x -> RollRate`
    """
    for there, back in _pairs(directions_of(subject, directed)):
        returning: dict[tuple[str, ...], list[Placed[bridge.FieldAssignment]]] = {}
        for placed in _fields(back):
            returning.setdefault(_paths(placed.sources), []).append(placed)
        for placed in _fields(there):
            returns = returning.get(_paths(placed.targets), [])
            if returns and not any(map(units_clash, (placed, *returns))):
                yield from _trip_findings(placed, returns)


@rule("JML438", "variance in a wrong place", severity=Severity.WARNING, kinds=Direction)
def covariances(_: Subject, direction: Direction) -> Iterator[Finding]:
    """A root mean square goes to a variance on the diagonal of a covariance matrix, as its square.

    The matrices of ROS are 3x3 (cells 0, 4, 8) or 6x6 (0, 7, 14, 21, 28, 35), row by row.

    Bad: `target="pose.covariance[1]" source="Position_RMS"` with the conversion square

    Good: `target="pose.covariance[0]"`
    """
    for placed in direction.of_kind(bridge.FieldAssignment):
        ends = zip(placed.targets, placed.sources, strict=False)
        yield from _cell_findings(placed, [*placed.sources, *placed.targets])
        if len(placed.sources) == len(placed.targets) == 1:
            for target, source in ends:
                yield from _square_findings(placed, source, target)


def _pairs(directions: Iterable[Direction]) -> Iterator[tuple[Direction, Direction]]:
    there: dict[bridge.AttributeMap, Direction] = {}
    for direction in directions:
        # Stops and safe values have no way back.
        if direction.owner is not direction.map:
            continue
        if direction.to_ros:
            there[direction.map] = direction
        elif direction.map in there:
            yield there[direction.map], direction


def _fields(direction: Direction) -> Iterator[Placed[bridge.FieldAssignment]]:
    for placed in direction.of_kind(bridge.FieldAssignment):
        is_found = placed.source_attributes and placed.target_attributes
        if is_found and not placed.scope.is_nested:
            yield placed


def _paths(ends: Iterable[tuple[str, Found]]) -> tuple[str, ...]:
    return tuple(path for path, _ in ends)


def _trip_findings(
    there: Placed[bridge.FieldAssignment], returns: list[Placed[bridge.FieldAssignment]]
) -> Iterator[Finding]:
    sources = _paths(there.sources)
    same = [back for back in returns if set(_paths(back.targets)) & set(sources)]
    if not same:
        if not _is_selective(there, returns):
            yield _other_field(there, returns[0])
        return
    for back in same:
        targets = _paths(back.targets)
        if len(sources) == len(targets) == 1:
            yield from _number_findings(there, back)
        elif _is_inverse(there, back) and sources != targets:
            yield _other_field(there, back)


def _is_selective(
    there: Placed[bridge.FieldAssignment], returns: list[Placed[bridge.FieldAssignment]]
) -> bool:
    """Whether several values meet in one, so that each way back gives a part of it alone."""
    return len(there.sources) > 1 or any(len(back.targets) > 1 for back in returns)


def _is_inverse(
    there: Placed[bridge.FieldAssignment], back: Placed[bridge.FieldAssignment]
) -> bool:
    first = [conversion_of(conversion).inverse for conversion in there.assignment.conversions]
    second = [conversion.kind.name for conversion in back.assignment.conversions]
    return len(first) == 1 and first == second


def _other_field(
    there: Placed[bridge.FieldAssignment], back: Placed[bridge.FieldAssignment]
) -> Finding:
    goes, comes = there.assignment, back.assignment
    message = f"'{comes.source}' becomes {comes.target}, but it was made from {goes.source}"
    note = Note(goes, f"'{goes.target}'", "source")
    return Finding(comes, message, "target", related=(note,))


def _number_findings(
    there: Placed[bridge.FieldAssignment], back: Placed[bridge.FieldAssignment]
) -> Iterator[Finding]:
    attribute = there.source_attributes[0]
    if attribute.kind != NUMBER or _shares_table(there, back):
        return
    step, between = attribute.step or 0.0, there.target_attributes[0]
    part = _SINGLE if attribute.is_single or between.is_single else _EXACT
    for value in _samples(there, attribute):
        try:
            sent = sent_through(there, value)
            # An integer between both ways rounds what passes.
            result = sent_through(back, round(sent) if between.integral else sent)
        except (NoValueError, OverflowError, ValueError):
            continue
        if _distance(result, value) > step + part * max(1.0, abs(value)):
            message = f"{value:.9g} of '{there.assignment.source}' comes back as {result:.9g}"
            note = Note(there.assignment, f"'{there.assignment.target}'", "target")
            yield Finding(back.assignment, message, "target", related=(note,))
            return


def _distance(first: float, second: float) -> float:
    """How far two numbers are apart; whole turns of an angle do not count."""
    apart = abs(first - second)
    return 0.0 if abs(apart - math.tau) < _EXACT else apart


def _shares_table(
    there: Placed[bridge.FieldAssignment], back: Placed[bridge.FieldAssignment]
) -> bool:
    """Whether both ways use one table, whose repeated values its author has ordered."""
    tables = [
        conversion.table
        for conversion in there.assignment.conversions
        if conversion.table is not None
    ]
    return any(
        conversion.table in tables for conversion in back.assignment.conversions if conversion.table
    )


def _samples(there: Placed[bridge.FieldAssignment], attribute: Attribute) -> Iterator[float]:
    for conversion in there.assignment.conversions:
        for entry in conversion.table.entries if conversion.table is not None else ():
            try:
                yield float(entry.jaus)
            except (TypeError, ValueError):
                continue
    low, high = source_range(attribute) or (-math.inf, math.inf)
    if math.isfinite(low) and math.isfinite(high):
        samples = (low + part * (high - low) for part in _PARTS)
        yield from (math.floor(sample) if attribute.integral else sample for sample in samples)
    else:
        yield from (sample for sample in _SAMPLES if low <= sample <= high)


def _cell_findings(
    placed: Placed[bridge.FieldAssignment], ends: Iterable[tuple[str, Found]]
) -> Iterator[Finding]:
    if not _is_of_variances(placed):
        return
    for path, attribute in ends:
        size = _matrix_size(attribute)
        match = _CELL.fullmatch(path)
        if not size or match is None or int(match[2]) % (size + 1) == 0:
            continue
        cells = ", ".join(str(index * (size + 1)) for index in range(size))
        row, column = divmod(int(match[2]), size)
        message = f"'{path}' is the covariance of {row} and {column}, no variance"
        feature = "source" if path in _paths(placed.sources) else "target"
        yield Finding(placed.assignment, message, feature, f"variances are {cells}")


def _is_of_variances(placed: Placed[bridge.FieldAssignment]) -> bool:
    effects = {conversion_of(conversion).units for conversion in placed.assignment.conversions}
    ends = [*placed.source_attributes, *placed.target_attributes]
    is_deviation = any(_is_deviation(end) for end in ends)
    return is_deviation or not effects.isdisjoint({UnitEffect.SQUARE, UnitEffect.ROOT})


def _is_deviation(attribute: Found) -> bool:
    return isinstance(attribute, Attribute) and "rms" in attribute.label.lower().split("_")


def _matrix_size(attribute: Found) -> int:
    if not isinstance(attribute, Attribute) or "covariance" not in attribute.label:
        return 0
    return (
        _MATRICES.get(attribute.field.arraySize, 0) if isinstance(attribute.field, ros.Field) else 0
    )


def _square_findings(
    placed: Placed[bridge.FieldAssignment], source: tuple[str, Found], target: tuple[str, Found]
) -> Iterator[Finding]:
    conversions = placed.assignment.conversions
    # A standard deviation that is made something else is no variance by mistake.
    if any(conversion_of(conversion).effect is Effect.OTHER for conversion in conversions):
        return
    if units_clash(placed):
        return
    if _is_deviation(source[1]) and _matrix_size(target[1]):
        message = f"'{source[0]}' is a root mean square, but '{target[0]}' is a variance"
        yield Finding(placed.assignment, message, "target", f"add the conversion {Square.name}")
    elif _matrix_size(source[1]) and _is_deviation(target[1]):
        message = f"'{source[0]}' is a variance, but '{target[0]}' is a root mean square"
        yield Finding(placed.assignment, message, "target", f"add the conversion {SquareRoot.name}")
