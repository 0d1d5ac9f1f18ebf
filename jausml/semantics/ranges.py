"""Ranges along an assignment: the least and the greatest number that each conversion may yield.

A range is never narrower than the truth. Ends that nothing limits are infinite; not a number lies
in every range, because no limit keeps it out.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from jausml.languages import intervals
from jausml.languages.expressions import ExpressionError, interval, parse_expression, variables
from jausml.languages.intervals import EVERYTHING, Interval
from jausml.metamodel.classes import ros
from jausml.semantics.attributes import BOOL, NUMBER, Attribute
from jausml.semantics.expressions import expression_names
from jausml.semantics.units import result_step

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.metamodel.classes import bridge
    from jausml.semantics.paths import Placed

_TURN = (-math.pi, math.pi)
_QUARTER = (-math.pi / 2, math.pi / 2)
_FIXED = {
    "ned_heading_to_enu_yaw": (_TURN,),
    "enu_yaw_to_ned_heading": (_TURN,),
    "wrap_angle": (_TURN,),
    "flu_quaternion_to_frd_roll": (_TURN,),
    "flu_quaternion_to_frd_pitch": (_QUARTER,),
    "flu_quaternion_to_frd_yaw": (_TURN,),
    "enu_quaternion_to_ned_heading": (_TURN,),
    "flu_quaternion_to_frd_angles": (_TURN, _QUARTER, _TURN),
    "enu_quaternion_to_ned_angles": (_TURN, _QUARTER, _TURN),
    "occupancy_to_cost": ((0.0, 255.0),),
    "cost_to_occupancy": ((-1.0, 100.0),),
}
_NOT_NEGATIVE = (0.0, math.inf)


def result_ranges(placed: Placed[bridge.FieldAssignment]) -> list[Interval]:
    """Returns the range of each value that an assignment yields, in the unit of its targets.

    Args:
        placed: A FieldAssignment whose paths lead somewhere.

    Returns:
        One range for each target, `EMPTY` for a value that there never is; empty for what is no
        number.
    """
    current = [source_range(each) for each in placed.source_attributes]
    if None in current and not placed.assignment.conversions:
        return []
    known = [each if each is not None else EVERYTHING for each in current]
    for position, conversion in enumerate(placed.assignment.conversions):
        known = converted(placed, position, conversion, known)
    step = result_step(placed)
    if step is not None:
        known = [_linear(each, *step) for each in known]
    return known


def source_range(attribute: Attribute) -> Interval | None:
    """Returns the range of the values that an attribute may have; None for what is no number."""
    if attribute.kind == BOOL:
        return 0.0, 1.0
    if attribute.kind != NUMBER:
        return None
    lower = -math.inf if attribute.lower is None else float(attribute.lower)
    upper = math.inf if attribute.upper is None else float(attribute.upper)
    if attribute.is_single and attribute.is_ros and not _is_narrowed(attribute):
        return EVERYTHING
    if attribute.values:
        low, high = intervals.hull(*attribute.values)
        return max(lower, float(low)), min(upper, float(high))
    return lower, upper


def converted(
    placed: Placed[bridge.FieldAssignment],
    position: int,
    conversion: Any,
    known: Sequence[Interval],
) -> list[Interval]:
    """Returns the ranges of what a conversion yields.

    Args:
        placed: The assignment.
        position: Which of its conversions it is.
        conversion: The conversion.
        known: Ranges of what it works on.
    """
    name = conversion.kind.name
    if name in _FIXED:
        return list(_FIXED[name])
    if any(map(intervals.is_empty, known)):
        return [intervals.EMPTY]
    if name == "expression":
        return [_expression(placed, position, conversion, known)]
    if name == "look_up":
        return [_looked_up(conversion, to_ros=placed.scope.to_ros)]
    if name == "covariance_to_rms":
        # The greatest of the three bounds their mean and their sum thrice.
        largest = max(0.0, *(high for _, high in known))
        return [(0.0, math.sqrt(3.0 * largest))]
    return [_single(name, arguments_of(conversion), known[0])]


def arguments_of(conversion: bridge.Conversion) -> list[float]:
    """Returns the arguments of a conversion, the value of its quantity in their place."""
    if conversion.quantity is not None:
        return [float(conversion.quantity.value)]
    return [float(each) for each in conversion.arguments]


def _is_narrowed(attribute: Attribute) -> bool:
    field = attribute.field
    return isinstance(field, ros.PrimitiveField) and field.minimum < field.maximum


def _single(name: str, arguments: Sequence[float], value: Interval) -> Interval:
    """The range of a conversion of one number; that of all numbers where nothing is known."""
    if name in ("clamp", "deadband", "scale", "linear", "value_to_percent", "percent_to_value"):
        if len(arguments) != (2 if name in ("clamp", "linear") else 1):
            return EVERYTHING
        return _with_arguments(name, arguments, value)
    if name == "negate":
        return intervals.negated(value)
    if name == "with_units":
        return value
    if name == "square":
        return intervals.power(value, (2.0, 2.0))
    if name == "degrees_to_radians":
        return _linear(value, math.radians(1.0))
    if name == "radians_to_degrees":
        return _linear(value, math.degrees(1.0))
    if name == "square_root":
        within = intervals.meet(value, _NOT_NEGATIVE)
        if intervals.is_empty(within):
            return within
        return math.sqrt(within[0]), math.sqrt(within[1])
    return EVERYTHING


def _with_arguments(name: str, arguments: Sequence[float], value: Interval) -> Interval:
    first = arguments[0]
    if name == "clamp":
        low, high = first, arguments[1]
        return min(max(value[0], low), high), max(min(value[1], high), low)
    if name == "deadband":
        reaches = value[0] < first and value[1] > -first
        return intervals.hull(value, (0.0, 0.0)) if reaches else value
    if name == "value_to_percent":
        return _linear(value, 100.0 / first) if first else EVERYTHING
    if name == "percent_to_value":
        return _linear(value, first / 100.0)
    return _linear(value, *arguments)


def _linear(value: Interval, factor: float, offset: float = 0.0) -> Interval:
    if factor == 0.0:
        return offset, offset
    return intervals.total(intervals.product(value, (factor, factor)), (offset, offset))


def _expression(
    placed: Placed[bridge.FieldAssignment],
    position: int,
    conversion: Any,
    known: Sequence[Interval],
) -> Interval:
    try:
        expression = parse_expression(conversion.expression or "")
    except ExpressionError:
        return EVERYTHING
    names = expression_names(placed, position)
    if not all(name in names and names[name] < len(known) for name in variables(expression)):
        return EVERYTHING
    ranges = {name: known[index] if index >= 0 else _NOT_NEGATIVE for name, index in names.items()}
    found = interval(expression, ranges)
    return intervals.EMPTY if found is None else found


def _looked_up(conversion: Any, *, to_ros: bool) -> Interval:
    entries = conversion.table.entries if conversion.table is not None else ()
    numbers = []
    for entry in entries:
        try:
            numbers.append(float(entry.ros if to_ros else entry.jaus))
        except (TypeError, ValueError):
            return EVERYTHING
    return (min(numbers), max(numbers)) if numbers else EVERYTHING
