"""Expressions as trees, and the functions that they may call."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from jausml.language.attributes import intervals as spans
from jausml.language.attributes.intervals import Interval


@dataclass(frozen=True)
class Number:
    """A number, which may be infinite or not a number."""

    value: float


@dataclass(frozen=True)
class Variable:
    """A source by its name."""

    name: str
    column: int = 0


@dataclass(frozen=True)
class Operation:
    """An operator between or before operands.

    Attributes:
        sign: `+ - * / ^ < <= > >= == != and or not`; `-` has one operand or two.
    """

    sign: str
    operands: tuple[Expression, ...]


@dataclass(frozen=True)
class Call:
    """A function of `FUNCTIONS` with its arguments."""

    function: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True)
class Conditional:
    """One of two values."""

    condition: Expression
    then: Expression
    otherwise: Expression


Expression = Number | Variable | Operation | Call | Conditional


def operands_of(expression: Expression) -> tuple[Expression, ...]:
    """Returns the expressions directly within an expression."""
    if isinstance(expression, Operation):
        return expression.operands
    if isinstance(expression, Call):
        return expression.arguments
    if isinstance(expression, Conditional):
        return expression.condition, expression.then, expression.otherwise
    return ()


def operations(expression: Expression) -> frozenset[str]:
    """Returns the signs of its operators and the names of its functions, `if` among them."""
    inner = frozenset[str]().union(*map(operations, operands_of(expression)))
    match expression:
        case Operation(sign=name) | Call(function=name):
            return inner | {name}
        case Conditional():
            return inner | {"if"}
    return inner


def occurrences(expression: Expression) -> Iterator[Variable]:
    """Yields the variables in the order in which they stand, each as often as it stands there."""
    if isinstance(expression, Variable):
        yield expression
    for operand in operands_of(expression):
        yield from occurrences(operand)


def variables(expression: Expression) -> tuple[str, ...]:
    """Returns the names of the variables, each once, in the order in which they stand."""
    return tuple(dict.fromkeys(occurrence.name for occurrence in occurrences(expression)))


def opposite(condition: Expression) -> Expression:
    """Returns the condition that holds where another one does not, in its shortest form."""
    match condition:
        case Operation(sign="not", operands=(only,)):
            return only
        case Operation(sign="==" | "!=" as sign, operands=operands):
            return Operation("!=" if sign == "==" else "==", operands)
        case Operation(sign="and" | "or" as sign, operands=operands):
            return Operation("or" if sign == "and" else "and", tuple(map(opposite, operands)))
    return Operation("not", (condition,))


def source_names(paths: Sequence[str]) -> dict[str, int]:
    """Returns the names that expressions may use for sources, with the index of the source.

    A source is named by the last step of its path, by more of its last steps, or by its whole path;
    a name that fits several names none of them. A single source is also `value`, and several are
    `value1`, `value2` and so on.
    """
    indices_by_name: dict[str, list[int]] = {}
    for index, path in enumerate(paths):
        steps = [] if path == "." else path.lstrip("/").split(".")
        for start in range(len(steps)):
            indices_by_name.setdefault(".".join(steps[start:]), []).append(index)
    names = {name: indices[0] for name, indices in indices_by_name.items() if len(indices) == 1}
    # The whole path always names its source, also where it ends another one.
    names.update({path.lstrip("/"): index for index, path in enumerate(paths) if path != "."})
    for index in range(len(paths)):
        names.setdefault("value" if len(paths) == 1 else f"value{index + 1}", index)
    return names


class Function(NamedTuple):
    """A function that expressions may call.

    Attributes:
        compute: Its value; ValueError and OverflowError where it has none.
    """

    compute: Callable[..., float]
    bound: Callable[..., Interval]
    fewest: int = 1
    most: int = 1


def _sign(value: float) -> float:
    return value if value == 0.0 or math.isnan(value) else math.copysign(1.0, value)


def _least(*values: float) -> float:
    return math.nan if any(map(math.isnan, values)) else min(values)


def _greatest(*values: float) -> float:
    return math.nan if any(map(math.isnan, values)) else max(values)


def _whole(function: Callable[[float], int]) -> Callable[[float], float]:
    """Returns a function to whole numbers that takes infinite values as they are."""
    return lambda value: float(function(value)) if math.isfinite(value) else value


_FLOOR, _CEIL, _ROUND = _whole(math.floor), _whole(math.ceil), _whole(round)
_SOME = 20

FUNCTIONS: dict[str, Function] = {
    "sin": Function(math.sin, spans.sine),
    "cos": Function(math.cos, spans.cosine),
    "tan": Function(math.tan, spans.tangent),
    "asin": Function(math.asin, spans.increasing(math.asin, (-1.0, 1.0))),
    "acos": Function(math.acos, spans.arc_cosine),
    "atan": Function(math.atan, spans.increasing(math.atan)),
    "atan2": Function(math.atan2, spans.direction, 2, 2),
    "sqrt": Function(math.sqrt, spans.increasing(math.sqrt, (0.0, math.inf), exact=True)),
    "abs": Function(abs, spans.absolute),
    "min": Function(_least, spans.least, 2, _SOME),
    "max": Function(_greatest, spans.greatest, 2, _SOME),
    "floor": Function(_FLOOR, spans.increasing(_FLOOR, exact=True)),
    "ceil": Function(_CEIL, spans.increasing(_CEIL, exact=True)),
    "round": Function(_ROUND, spans.increasing(_ROUND, exact=True)),
    "sign": Function(_sign, spans.increasing(_sign, exact=True)),
    "hypot": Function(math.hypot, spans.length, 2, 2),
    "fmod": Function(math.fmod, spans.modulo, 2, 2),
    "remainder": Function(math.remainder, spans.remainder, 2, 2),
    "isfinite": Function(math.isfinite, lambda _: spans.EITHER),
}
"""The functions by name. Angles are radians; `round` takes the even one of two neighbours.

What `fmod` leaves has the sign of the dividend; what `remainder` leaves, the nearest multiple being
taken away, lies within half of the divisor: `remainder(angle, 2 * pi)` is the same direction.
"""

OPERATORS: dict[tuple[str, int], Function] = {
    ("-", 1): Function(operator.neg, spans.negated),
    ("+", 2): Function(operator.add, spans.total),
    ("-", 2): Function(operator.sub, spans.difference),
    ("*", 2): Function(operator.mul, spans.product),
    ("/", 2): Function(operator.truediv, spans.quotient),
    ("^", 2): Function(math.pow, spans.power),
    ("<", 2): Function(operator.lt, spans.less),
    ("<=", 2): Function(operator.le, spans.at_most),
    (">", 2): Function(operator.gt, lambda a, b: spans.less(b, a)),
    (">=", 2): Function(operator.ge, lambda a, b: spans.at_most(b, a)),
    ("==", 2): Function(operator.eq, spans.equal),
    ("!=", 2): Function(operator.ne, lambda a, b: spans.inverse(spans.equal(a, b))),
}
"""The operators that compute from the values of their operands, by sign and number of operands."""
