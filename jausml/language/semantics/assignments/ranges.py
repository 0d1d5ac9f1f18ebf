"""Ranges of the numbers that assignments yield, and single numbers sent through them."""

from __future__ import annotations

import math

from jausml.language.attributes import intervals
from jausml.language.attributes.intervals import EVERYTHING, Interval
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.semantics.assignments.steps import steps_of
from jausml.language.semantics.assignments.units import result_step
from jausml.language.semantics.conversions import VALUE, NoValueError
from jausml.language.semantics.conversions.conversion import linear_interval
from jausml.language.semantics.paths import attributes
from jausml.language.semantics.paths.scopes import Placed


def result_ranges(placed: Placed[bridge.FieldAssignment]) -> list[Interval]:
    """Returns the range of each value that an assignment yields, in the unit of its targets.

    Returns:
        One range for each target, `EMPTY` for a value that there never is; empty for what is no
        number.
    """
    current = [source_range(source_attribute) for source_attribute in placed.source_attributes]
    if None in current and not placed.assignment.conversions:
        return []
    known = [interval if interval is not None else EVERYTHING for interval in current]
    for step in steps_of(placed):
        known = step.ranges(known)
    to_target = result_step(placed)
    if to_target is not None:
        known = [linear_interval(interval, *to_target) for interval in known]
    return known


def source_range(attribute: attributes.Attribute) -> Interval | None:
    """Returns the range of the values that an attribute may have; None for what is no number."""
    if attribute.kind == attributes.BOOL:
        return 0.0, 1.0
    if attribute.kind != attributes.NUMBER:
        return None
    lower = -math.inf if attribute.lower is None else float(attribute.lower)
    upper = math.inf if attribute.upper is None else float(attribute.upper)
    # A float32 of ROS holds infinities too, unless the model narrows it.
    if attribute.is_single and attribute.is_ros and not _is_narrowed(attribute):
        return EVERYTHING
    if attribute.values:
        low, high = intervals.hull(*attribute.values)
        return max(lower, float(low)), min(upper, float(high))
    return lower, upper


def _is_narrowed(attribute: attributes.Attribute) -> bool:
    field = attribute.field
    return isinstance(field, ros.PrimitiveField) and field.minimum < field.maximum


def sent_through(placed: Placed[bridge.FieldAssignment], value: float) -> float:
    """Returns the result of an assignment with one source and one target for a number.

    Raises:
        NoValueError: A conversion is not one of numbers, or limits this number.
    """
    for step in steps_of(placed):
        if step.conversion.outputs not in ((attributes.NUMBER,), (VALUE,)) or step.loses([value]):
            raise NoValueError(step.name)
        (result,) = step.forward([value])
        if not isinstance(result, float | int):
            raise NoValueError(step.name)
        value = result
    factor, offset = result_step(placed) or (1.0, 0.0)
    return value * factor + offset
