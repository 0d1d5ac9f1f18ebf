"""Rules about the values of fields: scales and value sets (AS5684)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, rule

WithValues: TypeAlias = "jaus.FixedField | jaus.Alternative | jaus.SubField"


@rule("JML325", "impossible scaling", kinds=jaus.ScaleRange)
def scale_range(subject: Subject, scale: jaus.ScaleRange) -> Iterator[Finding]:
    """A scaled field is an unsigned integer whose range maps onto lower..upper.

    The limits are finite and lower is below upper; a scaled field has no value set (AS5684,
    scale_range).

    Bad: `type="float32"` with a scale, or `<scale lower="1.0" upper="-1.0"/>`

    Good: `type="uint16"` with `<scale lower="-1.0" upper="1.0"/>`
    """
    field = scale.eContainer()
    if field is None or not subject.is_read(field):
        return
    name = field.name
    if not (math.isfinite(scale.lower) and math.isfinite(scale.upper)):
        yield Finding(scale, f"the scale of '{name}' has a limit that is not finite")
    elif scale.lower >= scale.upper:
        message = f"the scale of '{name}' has lower {scale.lower:g} and upper {scale.upper:g}"
        yield Finding(scale, message, "lower", "lower is below upper")
    if field.type.name not in wire.UNSIGNED:
        message = f"'{name}' is scaled, but {field.type.name} is no unsigned integer"
        yield Finding(field, message, "type")
    if field.values is not None:
        yield Finding(field, f"'{name}' has both a scale and a value set", "values")


@rule("JML329", "impossible value set", kinds=jaus.ValueSet)
def value_sets(subject: Subject, value_set: jaus.ValueSet) -> Iterator[Finding]:
    """The legal values of a field can occur in its type, and ranges are not empty.

    A range of an integer field contains an integer: a range above 1 and below 2 is empty. A set
    that counts from its lower limit is one of integers, and so is the limit (AS5684,
    offset_to_lower_limit).

    Bad: `<values xsi:type="jaus:EnumeratedValue" name="BIG" value="256"/>` in a uint8

    Good: `value="255"`, or `type="uint16"`
    """
    field = value_set.eContainer()
    if field is None or not subject.is_read(field):
        return
    values = [value for value in value_set.values if subject.is_read(value)]
    limits = _limits(field)
    if value_set.offsetToLowerLimit and len(values) == len(value_set.values):
        fault, limits = _counted_limits(value_set, limits)
        if fault:
            message = f"the values of '{field.name}' cannot count from their lower limit"
            yield Finding(value_set, f"{message}: {fault}", "offsetToLowerLimit")
    for value in values:
        yield from _value_findings(value, field, limits)


def _limits(field: WithValues) -> tuple[int, int] | None:
    if isinstance(field, jaus.SubField):
        return (0, 2 ** (field.highBit - field.lowBit + 1) - 1) if _is_sane(field) else None
    kind = wire.INTEGERS.get(field.type.name)
    return (kind.lower, kind.upper) if kind else None


def _counted_limits(
    value_set: jaus.ValueSet, limits: tuple[int, int] | None
) -> tuple[str, tuple[int, int] | None]:
    """Returns why a set cannot count from its lower limit, and the limits of what it can say."""
    if limits is None:
        return "only integers do", None
    try:
        offset = wire.offset_of(value_set)
    except wire.LayoutError:
        return "it is no integer", limits
    return "", (limits[0] + offset, limits[1] + offset)


def _is_sane(part: jaus.SubField) -> bool:
    return 0 <= part.lowBit <= part.highBit < wire.UNSIGNED["uint64"].bits


def _value_findings(
    value: jaus.Value, field: WithValues, limits: tuple[int, int] | None
) -> Iterator[Finding]:
    if isinstance(value, jaus.ValueRange):
        yield from _range_findings(value, field, limits)
    elif not isinstance(value, jaus.EnumeratedValue) or limits is None:
        return
    elif not limits[0] <= value.value <= limits[1]:
        message = f"value {value.value} of '{field.name}' is not in {limits[0]}..{limits[1]}"
        yield Finding(value, message, "value")


def _range_findings(
    value: jaus.ValueRange, field: WithValues, limits: tuple[int, int] | None
) -> Iterator[Finding]:
    if not value.lower <= value.upper:
        message = f"a range of '{field.name}' has lower {value.lower:g} and upper {value.upper:g}"
        yield Finding(value, message, "lower")
    elif _is_empty(value, integral=limits is not None):
        yield Finding(value, f"a range of '{field.name}' has no legal value", "lower")
    elif limits is not None:
        # The ends of a range are reals, which round the largest integers of 64 bits up.
        lower, upper = map(float, limits)
        if not lower <= value.lower <= value.upper <= upper:
            message = f"range {value.lower:g}..{value.upper:g} of '{field.name}'"
            feature = "lower" if value.lower < lower else "upper"
            yield Finding(value, f"{message} is not in {limits[0]}..{limits[1]}", feature)


def _is_empty(value: jaus.ValueRange, *, integral: bool) -> bool:
    """Whether a range whose limits are in order has no value between them."""
    if integral:
        stated = wire.Interval(value.lower, value.upper, value.lowerInclusive, value.upperInclusive)
        return stated.first > stated.last
    return value.lower == value.upper and not (value.lowerInclusive and value.upperInclusive)
