"""Arithmetic expressions of attribute maps: read, evaluated and bounded, and never run as code.

`parsing` has the grammar, `functions` the functions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .. import intervals as spans
from .parsing import COMPARISONS, CONSTANTS, DEEPEST, LONGEST, ExpressionError, parse_expression
from .tree import (
    FUNCTIONS,
    OPERATORS,
    Call,
    Conditional,
    Expression,
    Function,
    Number,
    Operation,
    Variable,
    occurrences,
    operands_of,
    operations,
    source_names,
    variables,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..intervals import Interval

__all__ = [
    "COMPARISONS",
    "CONSTANTS",
    "DEEPEST",
    "FUNCTIONS",
    "LONGEST",
    "Call",
    "Conditional",
    "EvaluationError",
    "Expression",
    "ExpressionError",
    "Number",
    "Operation",
    "Variable",
    "evaluate",
    "interval",
    "occurrences",
    "operands_of",
    "operations",
    "parse_expression",
    "source_names",
    "variables",
]

_CONNECTIVES = {"and", "or", "not"}


class EvaluationError(ValueError):
    """An expression has no value for some values of its sources."""


def evaluate(expression: Expression, values: Mapping[str, float]) -> float:
    """Returns the value of an expression.

    Raises:
        EvaluationError: It has none there: it divides by zero, or a function is outside of its
            domain.
        KeyError: A variable has no value.
    """
    if isinstance(expression, Number):
        return expression.value
    if isinstance(expression, Variable):
        return float(values[expression.name])
    if isinstance(expression, Conditional):
        holds = evaluate(expression.condition, values) != 0.0
        return evaluate(expression.then if holds else expression.otherwise, values)
    operands = operands_of(expression)
    if isinstance(expression, Operation) and expression.sign in _CONNECTIVES:
        found = (evaluate(operand, values) != 0.0 for operand in operands)
        if expression.sign == "not":
            return float(not next(found))
        return float(all(found) if expression.sign == "and" else any(found))
    numbers = [evaluate(operand, values) for operand in operands]
    try:
        return float(_function_of(expression).compute(*numbers))
    except (ValueError, OverflowError, ZeroDivisionError):
        name = expression.function if isinstance(expression, Call) else expression.sign
        raise EvaluationError(f"{name} has no value for {', '.join(map(str, numbers))}") from None


def interval(expression: Expression, intervals: Mapping[str, Interval]) -> Interval | None:
    """Returns least and greatest value that an expression may have; None when it never has one.

    The result is never narrower than the truth, but may be wider: a variable that stands in several
    places counts there as several.

    Args:
        intervals: Least and greatest value of each variable; they may be infinite.

    Raises:
        KeyError: A variable has no interval.
    """
    found = _bound(expression, intervals)
    return None if spans.is_empty(found) else found


def _bound(expression: Expression, known: Mapping[str, Interval]) -> Interval:
    if isinstance(expression, Number):
        # What is not a number lies in no interval.
        value = expression.value
        return spans.EMPTY if math.isnan(value) else (value, value)
    if isinstance(expression, Variable):
        low, high = known[expression.name]
        return float(low), float(high)
    if isinstance(expression, Conditional):
        return _bound_choice(expression, known)
    operands = [_bound(operand, known) for operand in operands_of(expression)]
    if isinstance(expression, Operation) and expression.sign in _CONNECTIVES:
        return _bound_truth(expression.sign, operands)
    if any(map(spans.is_empty, operands)):
        return spans.EITHER if _is_verdict(expression) else spans.EMPTY
    return _function_of(expression).bound(*operands)


def _is_verdict(expression: Operation | Call) -> bool:
    """Whether the result is 1 or 0 also for what is not a number."""
    if isinstance(expression, Call):
        return expression.function == "isfinite"
    return expression.sign in COMPARISONS


def _bound_choice(expression: Conditional, known: Mapping[str, Interval]) -> Interval:
    condition = _bound(expression.condition, known)
    # What is not a number counts as true.
    verdict = spans.TRUE if spans.is_empty(condition) else spans.truth(condition)
    if verdict == spans.TRUE:
        return _bound(expression.then, known)
    if verdict == spans.FALSE:
        return _bound(expression.otherwise, known)
    return spans.hull(_bound(expression.then, known), _bound(expression.otherwise, known))


def _bound_truth(sign: str, operands: Sequence[Interval]) -> Interval:
    # An operand without a value may be one that is never asked, and not a number counts as true.
    found = [spans.EITHER if spans.is_empty(each) else spans.truth(each) for each in operands]
    if sign == "not":
        return spans.inverse(found[0])
    return spans.least(*found) if sign == "and" else spans.greatest(*found)


def _function_of(expression: Operation | Call) -> Function:
    if isinstance(expression, Call):
        return FUNCTIONS[expression.function]
    return OPERATORS[expression.sign, len(expression.operands)]
