"""Definitions of conversions, in the language of expressions.

A definition is all that a printer, an evaluation or a proof has to know of a conversion. Its parts,
local values and results are real numbers of 64 bits (IEEE 754): the whole numbers of times and time
stamps are such too, since each that occurs is below 2^53. Where an operation has no value, as a
sine has none of an infinite angle, the definition chooses or refuses before.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from jausml.language.attributes.expressions import (
    EvaluationError,
    Expression,
    evaluate,
    interval,
    operations,
    parse_expression,
    variables,
)
from jausml.language.attributes.intervals import EMPTY, Interval
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP

QUATERNION = "geometry_msgs/Quaternion"

PARTS: Mapping[str, tuple[str, ...]] = {
    QUATERNION: ("x", "y", "z", "w"),
    TIME: ("sec", "nanosec"),
    TIME_STAMP: ("milliseconds", "seconds", "minutes", "hour", "day"),
}
"""The parts of values that are no single number, as definitions take and give them."""

_OF_LIBRARY = frozenset({"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot", "^"})


class NoArithmetic(Enum):
    """Kinds of work of conversions that have no arithmetic of their own."""

    ORDER = "gives the elements of a list in another order"
    PICTURE = "reads or writes the octets of a picture"
    TABLE = "finds the value in a table of the map"
    AUTHORED = "computes an expression of the map"
    USER = "calls a method that the user writes"


@dataclass(frozen=True)
class Definition:
    """Arithmetic on the parts of values.

    Where a conversion keeps integers, its operations are those of integers as well.

    Attributes:
        takes: Names of the parts of the inputs, then of the arguments, then those of `near`.
        text: Lines `name = expression` of local values, then a line for each result.
        refused: Where there is no result, a condition on what it takes; empty for nowhere.
    """

    takes: str
    text: str
    refused: str = ""
    reason: str = ""

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of its inputs, in order."""
        return tuple(self.takes.split(", "))

    @cached_property
    def refusal(self) -> Expression | None:
        """The condition under which there is no result."""
        return parse_expression(self.refused) if self.refused else None

    @cached_property
    def steps(self) -> Mapping[str, Expression]:
        """The local values by name, in order, that results need: each is made of those before."""
        needed = {name for result in self.results for name in variables(result)}
        expressions: dict[str, Expression] = {}
        # From the last line on: a local value is needed only by what comes behind it.
        for line in reversed(self._lines):
            name, is_step, text = line.partition(" = ")
            if is_step and name in needed:
                expressions[name] = parse_expression(text)
                needed.update(variables(expressions[name]))
        return dict(reversed(expressions.items()))

    @cached_property
    def results(self) -> tuple[Expression, ...]:
        """The parts of the results, in order."""
        return tuple(parse_expression(line) for line in self._lines if " = " not in line)

    @property
    def lines(self) -> tuple[str, ...]:
        """The lines of the text that the results need."""
        return tuple(
            line
            for line in self._lines
            if " = " not in line or line.partition(" = ")[0] in self.steps
        )

    @property
    def _lines(self) -> tuple[str, ...]:
        return tuple(filter(None, map(str.strip, self.text.splitlines())))

    @property
    def is_portable(self) -> bool:
        """Whether IEEE 754 fixes each bit of the results: a C library decides on those of sines."""
        return self._operations.isdisjoint(_OF_LIBRARY)

    def compute(self, values: Sequence[float]) -> tuple[float, ...]:
        """Returns the parts of the results."""
        known = dict(zip(self.parameters, values, strict=False))
        if self.refusal is not None and evaluate(self.refusal, known):
            raise EvaluationError(self.reason)
        for name, step in self.steps.items():
            known[name] = evaluate(step, known)
        return tuple(evaluate(result, known) for result in self.results)

    def bound(self, ranges: Sequence[Interval]) -> Interval:
        """Returns the range of the only result, for the ranges of the inputs."""
        known = dict(zip(self.parameters, ranges, strict=False))
        for name, step in self.steps.items():
            known[name] = interval(step, known) or EMPTY
        return interval(self.results[0], known) or EMPTY

    @property
    def _operations(self) -> frozenset[str]:
        return frozenset[str]().union(*map(operations, (*self.steps.values(), *self.results)))
