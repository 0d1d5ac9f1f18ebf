"""Steps of an assignment: its conversions with what each of them works with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.language.attributes.expressions import ExpressionError, parse_expression
from jausml.language.attributes.intervals import EVERYTHING, Interval
from jausml.language.semantics.conversions import (
    CONVERSIONS,
    ArgumentKind,
    Conversion,
    NoValueError,
    conversion_of,
)
from jausml.language.semantics.conversions.authored import Formula
from jausml.language.semantics.expressions import expression_names
from jausml.language.semantics.memory import remembered
from jausml.language.semantics.quantities import value_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.language.metamodel.classes import bridge
    from jausml.language.semantics.conversions import Argument
    from jausml.language.semantics.conversions.authored import Pairs, Scalar
    from jausml.language.semantics.paths import Placed


@dataclass(frozen=True, slots=True)
class Step:
    """A conversion on the way of an assignment."""

    conversion: Conversion
    arguments: tuple[Any, ...] | None

    @property
    def name(self) -> str:
        """Name of the conversion."""
        return self.conversion.name

    def forward(self, values: Sequence[Any]) -> list[Any]:
        """Returns what it makes of some values."""
        if self.arguments is None or self.conversion.needs_clock:
            raise NoValueError(self.name)
        try:
            result = self.conversion.forward(*values, *self.arguments)
        except (ArithmeticError, TypeError) as error:
            raise NoValueError(self.name) from error
        return list(result) if len(self.conversion.outputs) > 1 else [result]

    def loses(self, values: Sequence[Any]) -> bool:
        """Tells whether it takes something of some values away on purpose."""
        return self.arguments is not None and self.conversion.loses(*values, *self.arguments)

    def ranges(self, known: Sequence[Interval]) -> list[Interval]:
        """Returns the ranges of what it yields, of those of what it works on."""
        if self.arguments is None:
            return [EVERYTHING]
        return self.conversion.ranges(known, self.arguments)

    @property
    def leads_back(self) -> bool:
        """Whether each number that it yields comes from one number alone."""
        return self.arguments is not None and self.conversion.leads_back(*self.arguments)

    def back(self, value: float) -> float:
        """Returns the number that gives another one, where it leads back."""
        arguments = self.arguments or ()
        if not self.conversion.inverse:
            return self.conversion.back(value, *arguments)
        return float(CONVERSIONS[self.conversion.inverse].forward(value, *arguments))

    @property
    def sign(self) -> int | None:
        """What it makes of the sign of a number: 1, -1, or None where nothing is known."""
        return None if self.arguments is None else self.conversion.sign(*self.arguments)


@remembered
def steps_of(placed: Placed[bridge.FieldAssignment]) -> list[Step]:
    """Returns the conversions of an assignment, in order."""
    return [
        step_of(each, expression_names(placed, position), to_ros=placed.scope.to_ros)
        for position, each in enumerate(placed.assignment.conversions)
    ]


def step_of(
    element: bridge.Conversion,
    names: Mapping[str, int],
    *,
    to_ros: bool,
    quantities: Mapping[str, bridge.Quantity] | None = None,
) -> Step:
    """Returns a conversion of a model with its arguments.

    Args:
        names: What the names of an expression stand for: positions of its inputs, or -1.
        quantities: What stands in the place of quantities of the map, by name.
    """
    conversion = conversion_of(element)
    given = _numbers(element, quantities or {})
    others = [each for each in conversion.arguments if each.kind is not ArgumentKind.NUMBER]
    is_complete = len(given) == len(conversion.numbers)
    for argument in others:
        value = _argument(element, argument, names, to_ros=to_ros)
        is_complete = is_complete and value is not None
        given.append(value)
    return Step(conversion, tuple(given) if is_complete else None)


def _numbers(element: bridge.Conversion, quantities: Mapping[str, bridge.Quantity]) -> list[Any]:
    quantity = element.quantity
    if quantity is None:
        return [float(each) for each in element.arguments]
    return [value_of(quantity, quantities)]


def _argument(
    element: bridge.Conversion, argument: Argument, names: Mapping[str, int], *, to_ros: bool
) -> Formula | Pairs | str | None:
    """An argument that is no number; None when the model has none that can be used."""
    if argument.kind is ArgumentKind.TABLE:
        return _pairs(element.table, to_ros=to_ros) if element.table is not None else None
    if argument.kind is not ArgumentKind.FORMULA:
        text = getattr(element, argument.feature)
        return None if text is None else str(text)
    try:
        return Formula(parse_expression(element.expression or ""), names)
    except ExpressionError:
        return None


def _pairs(table: bridge.ValueTable, *, to_ros: bool) -> Pairs:
    ends = ((each.jaus, each.ros) if to_ros else (each.ros, each.jaus) for each in table.entries)
    return [(_scalar(taken), _scalar(given)) for taken, given in ends]


def _scalar(text: str | None) -> Scalar:
    """The number that a text stands for, or the text."""
    try:
        return float(text or "")
    except ValueError:
        return text or ""
