"""Steps: conversions of an assignment with their arguments, and the kinds of what they yield."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jausml.language.attributes.expressions import ExpressionError, parse_expression, source_names
from jausml.language.attributes.intervals import EVERYTHING, Interval
from jausml.language.attributes.units import UnitError, conversion_between, parse_unit
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions import (
    ANY,
    CONVERSIONS,
    VALUE,
    Argument,
    ArgumentKind,
    Conversion,
    NoValueError,
    conversion_of,
)
from jausml.language.semantics.conversions.authored import Expression, Formula, Pairs, Scalar
from jausml.language.semantics.paths.attributes import BOOL, LIST, NUMBER, NUMBERS, TEXT, Attribute
from jausml.language.semantics.paths.scopes import Placed
from jausml.language.semantics.subject import remembered


def value_of(quantity: bridge.Quantity, overrides: Mapping[str, bridge.Quantity]) -> float:
    """Returns the value of a quantity of a map, in the unit that the map states.

    Args:
        overrides: The quantities of the bridge by name. One that has another unit of the same
            dimension is converted: 30 km/h is 8.333 m/s.
    """
    stated = overrides.get(str(quantity.name))
    if stated is None:
        return float(quantity.value)
    if not stated.units or not quantity.units or stated.units == quantity.units:
        return float(stated.value)
    try:
        own, wanted = parse_unit(stated.units), parse_unit(quantity.units)
    except UnitError:
        return float(stated.value)
    if not own.is_compatible(wanted):
        return float(stated.value)
    factor, offset = conversion_between(own, wanted)
    return float(stated.value) * factor + offset


RESULT = "value"
"""How an expression calls what the conversion before it yields."""


def expression_names(placed: Placed[bridge.Assignment], position: int) -> dict[str, int]:
    """Returns the names of the inputs of an expression, with their positions.

    Args:
        position: Which of its conversions the expression is; the first works on the sources, each
            further one on the result of the one before.
    """
    return source_names([path for path, _ in placed.sources]) if position == 0 else {RESULT: 0}


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
        """Returns the results of the conversion for some values."""
        if self.arguments is None or self.conversion.needs_clock:
            raise NoValueError(self.name)
        try:
            result = self.conversion.forward(*values, *self.arguments)
        except (ArithmeticError, TypeError) as error:
            raise NoValueError(self.name) from error
        return list(result) if len(self.conversion.outputs) > 1 else [result]

    def loses(self, values: Sequence[Any]) -> bool:
        """Tells whether it drops a part of some values on purpose."""
        return self.arguments is not None and self.conversion.loses(*values, *self.arguments)

    def ranges(self, known: Sequence[Interval]) -> list[Interval]:
        """Returns the ranges of its results, for the ranges of its inputs."""
        if self.arguments is None:
            return [EVERYTHING]
        return self.conversion.ranges(known, self.arguments)

    @property
    def leads_back(self) -> bool:
        """Whether each result comes from one number alone."""
        return self.arguments is not None and self.conversion.leads_back(*self.arguments)

    def back(self, value: float) -> float:
        """Returns the input for a result, where there is only one."""
        arguments = self.arguments or ()
        if not self.conversion.inverse:
            return self.conversion.back(value, *arguments)
        return float(CONVERSIONS[self.conversion.inverse].forward(value, *arguments))

    @property
    def sign(self) -> int | None:
        """The factor on the sign of a number: 1, -1, or None where it is not known."""
        return None if self.arguments is None else self.conversion.sign(*self.arguments)


@remembered
def steps_of(placed: Placed[bridge.FieldAssignment]) -> list[Step]:
    """Returns the conversions of an assignment, in order."""
    return [
        step_of(conversion, expression_names(placed, position), to_ros=placed.scope.to_ros)
        for position, conversion in enumerate(placed.assignment.conversions)
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
        quantities: What stands in the place of quantities of the map, by name.
    """
    conversion = conversion_of(element)
    arguments = _numbers(element, quantities or {})
    others = [
        parameter for parameter in conversion.arguments if parameter.kind is not ArgumentKind.NUMBER
    ]
    is_complete = len(arguments) == len(conversion.numbers)
    for argument in others:
        value = _argument(element, argument, names, to_ros=to_ros)
        is_complete = is_complete and value is not None
        arguments.append(value)
    return Step(conversion, tuple(arguments) if is_complete else None)


def _numbers(element: bridge.Conversion, quantities: Mapping[str, bridge.Quantity]) -> list[Any]:
    quantity = element.quantity
    if quantity is None:
        return [float(argument) for argument in element.arguments]
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
    ends = (
        (entry.jaus, entry.ros) if to_ros else (entry.ros, entry.jaus) for entry in table.entries
    )
    return [(_scalar(taken), _scalar(result)) for taken, result in ends]


def _scalar(text: str | None) -> Scalar:
    """The number that a text stands for, or the text."""
    try:
        return float(text or "")
    except ValueError:
        return text or ""


_VALUES = (NUMBER, BOOL, TEXT)


@dataclass(frozen=True, slots=True)
class ChainFault:
    """The conversion of a chain that cannot take its input."""

    conversion: bridge.Conversion
    message: str


def knows_unknown(assignment: bridge.FieldAssignment | bridge.ListAssignment) -> bool:
    """Tells whether the first conversion makes a value of the marker of a source."""
    first = next(iter(assignment.conversions), None)
    return first is not None and conversion_of(first).knows_unknown


def chain_kinds(
    conversions: Sequence[bridge.Conversion], kinds: Sequence[str]
) -> list[str] | ChainFault:
    """Returns the kinds of what a chain of conversions yields."""
    current = list(kinds)
    for conversion in conversions:
        meaning = conversion_of(conversion)
        if ANY not in current and not meaning.takes(current):
            message = f"{conversion.kind.name} takes {', '.join(meaning.inputs)}"
            return ChainFault(conversion, f"{message}, but gets {', '.join(current)}")
        current = list(meaning.outputs)
    return current


def fits(value: Attribute, target: Attribute) -> bool:
    """Tells whether a value goes to a target without a conversion."""
    if value.kind in (LIST, NUMBERS):
        return False
    if value.kind == target.kind:
        return True
    kinds = {value.kind, target.kind}
    number = value if value.kind == NUMBER else target
    return kinds == {BOOL, NUMBER} and number.integral


def yields(conversion: bridge.Conversion, kind: str, target: Attribute) -> bool:
    """Tells whether the result of a conversion fits a target."""
    if kind == ANY:
        return True
    if kind == VALUE:
        return target.kind in _VALUES
    # The truth of an expression is 1 or 0, which a bool takes.
    is_truth = isinstance(conversion_of(conversion), Expression) and target.kind == BOOL
    return kind == target.kind or is_truth
