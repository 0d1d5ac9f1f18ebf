"""Numbers sent through the conversions of an assignment, as the runtime computes them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from jausml.languages.expressions import (
    EvaluationError,
    ExpressionError,
    evaluate,
    parse_expression,
)
from jausml.semantics.expressions import expression_names
from jausml.semantics.ranges import arguments_of
from jausml.semantics.units import result_step

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jausml.metamodel.classes import bridge
    from jausml.semantics.paths import Placed

_LARGEST_COST, _LARGEST_OCCUPANCY = 254, 100


class NoValueError(ValueError):
    """A number whose way through the conversions is not known, or is cut off on purpose."""


def sent_through(placed: Placed[bridge.FieldAssignment], value: float) -> float:
    """Returns what an assignment with one source and one target makes of a number.

    Args:
        placed: A FieldAssignment.
        value: The number, in the unit of the source.

    Raises:
        NoValueError: A conversion is not one of numbers, or limits this number.
    """
    for position, conversion in enumerate(placed.assignment.conversions):
        value = _converted(placed, position, conversion, value)
    factor, offset = result_step(placed) or (1.0, 0.0)
    return value * factor + offset


def _converted(
    placed: Placed[bridge.FieldAssignment], position: int, conversion: Any, value: float
) -> float:
    name, arguments = conversion.kind.name, arguments_of(conversion)
    try:
        if name == "expression":
            return _evaluated(placed, position, conversion, value)
        if name == "look_up":
            return _looked_up(conversion, value, to_ros=placed.scope.to_ros)
        if name in _ALONE:
            return _ALONE[name](value)
        if name in _WITH_ARGUMENTS:
            return _WITH_ARGUMENTS[name](value, arguments)
    except (ValueError, TypeError, ZeroDivisionError, OverflowError, IndexError) as error:
        raise NoValueError(name) from error
    raise NoValueError(name)


def _evaluated(
    placed: Placed[bridge.FieldAssignment], position: int, conversion: Any, value: float
) -> float:
    names = expression_names(placed, position)
    try:
        expression = parse_expression(conversion.expression or "")
        return evaluate(expression, {name: value for name, at in names.items() if at == 0})
    except (ExpressionError, EvaluationError, KeyError) as error:
        raise NoValueError(conversion.expression) from error


def _looked_up(conversion: Any, value: float, *, to_ros: bool) -> float:
    for entry in conversion.table.entries if conversion.table is not None else ():
        found, other = (entry.jaus, entry.ros) if to_ros else (entry.ros, entry.jaus)
        if float(found) == value:
            return float(other)
    raise NoValueError("look_up")


def _limited(value: float, arguments: Sequence[float]) -> float:
    if not arguments[0] <= value <= arguments[1]:
        raise NoValueError("clamp")
    return value


def _beyond(value: float, arguments: Sequence[float]) -> float:
    if abs(value) < arguments[0]:
        raise NoValueError("deadband")
    return value


def _wrapped(value: float) -> float:
    return math.remainder(value, math.tau)


def _turned(value: float) -> float:
    return _wrapped(math.pi / 2 - value)


def _cost(value: float) -> float:
    if not 0 <= value <= _LARGEST_OCCUPANCY:
        raise NoValueError("occupancy_to_cost")
    return value * _LARGEST_COST / _LARGEST_OCCUPANCY


def _occupancy(value: float) -> float:
    if not 0 <= value <= _LARGEST_COST:
        raise NoValueError("cost_to_occupancy")
    return value * _LARGEST_OCCUPANCY / _LARGEST_COST


_ALONE: dict[str, Callable[[float], float]] = {
    "negate": lambda value: -value,
    "square": lambda value: value * value,
    "square_root": math.sqrt,
    "degrees_to_radians": math.radians,
    "radians_to_degrees": math.degrees,
    "ned_heading_to_enu_yaw": _turned,
    "enu_yaw_to_ned_heading": _turned,
    "wrap_angle": _wrapped,
    "with_units": lambda value: value,
    "occupancy_to_cost": _cost,
    "cost_to_occupancy": _occupancy,
}
_WITH_ARGUMENTS: dict[str, Callable[[float, Sequence[float]], float]] = {
    "scale": lambda value, given: value * given[0],
    "linear": lambda value, given: value * given[0] + given[1],
    "value_to_percent": lambda value, given: value / given[0] * 100.0,
    "percent_to_value": lambda value, given: value / 100.0 * given[0],
    "clamp": _limited,
    "deadband": _beyond,
}
