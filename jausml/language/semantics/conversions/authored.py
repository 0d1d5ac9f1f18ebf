"""Authored conversions: what they do stands in the model or in the skeleton."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from jausml.language.attributes import expressions, intervals
from jausml.language.attributes.expressions import EvaluationError, evaluate, interval, variables
from jausml.language.attributes.intervals import EVERYTHING, Interval
from jausml.language.semantics.conversions.conversion import (
    ANY,
    VALUE,
    Argument,
    ArgumentKind,
    Conversion,
    Effect,
    NoValueError,
    UnitEffect,
)
from jausml.language.semantics.conversions.definition import Definition, NoArithmetic

Scalar: TypeAlias = "float | str"
Pairs: TypeAlias = "Sequence[tuple[Scalar, Scalar]]"


@dataclass(frozen=True, slots=True)
class Formula:
    """An expression of the model."""

    expression: expressions.Expression
    names: Mapping[str, int]


class WithUnits(Conversion):
    """States the units of the value at this point where its type has none; no number is changed."""

    name = "with_units"
    arguments = (Argument("units", ArgumentKind.TEXT),)
    units = UnitEffect.STATED
    inverse = "with_units"
    effect = Effect.SAME
    definition = Definition("value", "value")


class LookUp(Conversion):
    """The counterpart of the value in a table of the map.

    It is that of the JAUS value towards ROS, of the ROS value towards JAUS. A value that the table
    lacks drops the message.
    """

    name = "look_up"
    inputs = outputs = (VALUE,)
    arguments = (Argument("table", ArgumentKind.TABLE),)
    definition = NoArithmetic.TABLE

    def forward(self, value: Scalar, table: Pairs) -> Scalar:
        """The other one of the first pair that has the value."""
        for key, other in table:
            if key == value:
                return other
        raise NoValueError(self.name)

    def interval(self, _value: Interval, table: Pairs) -> Interval:
        """From the least to the greatest counterpart."""
        counterparts = [other for _, other in table]
        numbers = [counterpart for counterpart in counterparts if not isinstance(counterpart, str)]
        if not numbers or len(numbers) < len(counterparts):
            return EVERYTHING
        return min(numbers), max(numbers)


class Expression(Conversion):
    """The value of an arithmetic expression over the sources."""

    name = "expression"
    inputs = ("number+",)
    arguments = (Argument("expression", ArgumentKind.FORMULA),)
    definition = NoArithmetic.AUTHORED

    def forward(self, *arguments: Any) -> float:
        """The value for the inputs, then the formula."""
        *values, formula = arguments
        try:
            known = {name: values[at] for name, at in formula.names.items()}
            return evaluate(formula.expression, known)
        except (EvaluationError, KeyError, IndexError) as error:
            raise NoValueError(self.name) from error

    def interval(self, *arguments: Any) -> Interval:
        """The range for those of the inputs, then the formula."""
        *known, formula = arguments
        names = formula.names
        used = variables(formula.expression)
        if not all(name in names and names[name] < len(known) for name in used):
            return EVERYTHING
        bounds = interval(formula.expression, {name: known[names[name]] for name in used})
        return intervals.EMPTY if bounds is None else bounds


class User(Conversion):
    """A method of the skeleton of the bridge, which the user writes."""

    name = "user"
    inputs = (f"{ANY}+",)
    outputs = (ANY,)
    arguments = (Argument("method", ArgumentKind.METHOD),)
    definition = NoArithmetic.USER

    def forward(self, *_given: Any) -> Any:
        """Nobody but the user knows."""
        raise NoValueError(self.name)
