"""Expressions of attribute maps as trees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


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


def occurrences(expression: Expression) -> Iterator[Variable]:
    """Yields the variables in the order in which they stand, each as often as it stands there."""
    if isinstance(expression, Variable):
        yield expression
    for operand in operands_of(expression):
        yield from occurrences(operand)


def variables(expression: Expression) -> tuple[str, ...]:
    """Returns the names of the variables, each once, in the order in which they stand."""
    return tuple(dict.fromkeys(each.name for each in occurrences(expression)))


def source_names(paths: Sequence[str]) -> dict[str, int]:
    """Returns the names that expressions may use for sources, with the index of the source.

    A source is named by the last step of its path, by more of its last steps, or by its whole path;
    a name that fits several names none of them. A single source is also `value`, and several are
    `value1`, `value2` and so on.
    """
    found: dict[str, list[int]] = {}
    for index, path in enumerate(paths):
        steps = [] if path == "." else path.lstrip("/").split(".")
        for start in range(len(steps)):
            found.setdefault(".".join(steps[start:]), []).append(index)
    names = {name: indices[0] for name, indices in found.items() if len(indices) == 1}
    # The whole path always names its source, also where it ends another one.
    names.update({path.lstrip("/"): i for i, path in enumerate(paths) if path != "."})
    for index in range(len(paths)):
        names.setdefault("value" if len(paths) == 1 else f"value{index + 1}", index)
    return names
