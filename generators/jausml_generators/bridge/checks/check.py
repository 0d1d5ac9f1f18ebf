"""One function of the generated tests, and the figures in it: conversions, computed here."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from jausml.generation.literals import python_literal, python_string
from jausml.language.attributes.expressions import source_names
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.steps import RESULT, Step, step_of
from jausml.language.semantics.conversions import NoValueError
from jausml.language.semantics.paths.attributes import NUMBER
from jausml_generators.python.codec.messages import FORM_CLASS
from jausml_generators.python.statements import call

_WHOLE_MESSAGE = re.compile(r"\w+ = ")
_LEAST_TOLERANCE = 1e-9
_DEFAULT_OF_APPROX = 1e-6


NAME = "\1"
"""Stands for the name of a connection in checks that connections share."""


def frame_stand_in(number: int) -> str:
    """Returns the stand-in for the name of a frame of a map in checks that connections share."""
    return f"\2{number}\3"


@dataclass(frozen=True)
class Check:
    """A test of one translation.

    Attributes:
        name: Name of the function behind `test_`, unique in the module.
    """

    name: str
    documentation: str
    lines: tuple[str, ...]
    decorators: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()

    @property
    def body(self) -> str:
        """The statements, each on lines of its own."""
        return "\n".join(self.lines)

    def of(self, connection: str, class_name: str, frames: Iterable[str]) -> Check:
        """Returns the check with the names of a connection, its message and its frames."""
        stand_ins = {NAME: connection, FORM_CLASS: class_name}
        stand_ins |= {
            frame_stand_in(number): python_string(frame) for number, frame in enumerate(frames)
        }

        def named(text: str) -> str:
            for stand_in, own in stand_ins.items():
                text = text.replace(stand_in, own)
            return text

        return replace(
            self,
            name=named(self.name),
            documentation=named(self.documentation),
            lines=tuple(named(self.body).split("\n")),
        )


def tidy(statements: Iterable[str]) -> tuple[str, ...]:
    """Returns statements without assertions that are there already."""
    return tuple(_tidied(statements))


def _tidied(statements: Iterable[str]) -> Iterator[str]:
    known: set[str] = set()
    for statement in statements:
        if statement.startswith("assert "):
            if statement in known:
                continue
            known.add(statement)
        elif _WHOLE_MESSAGE.match(statement):
            known = set()
        yield statement


def store(place: str, code: str) -> str:
    """Returns the statement that stores a value."""
    return f"{place} = {code}"


def equals(place: str, code: str) -> str:
    """Returns the assertion that a place holds a value."""
    return f"assert {place} == {code}"


def holds(condition: str) -> str:
    """Returns the assertion that a condition holds."""
    return f"assert {condition}"


def close_to(place: str, value: float, tolerance: float = 0.0) -> str:
    """Returns the assertion that a place holds a number.

    Args:
        tolerance: Largest difference; 0 means the default of pytest, a millionth of the number.
    """
    if math.isnan(value):
        return holds(f"math.isnan({place})")
    arguments = [python_literal(float(value))]
    if tolerance > _DEFAULT_OF_APPROX * abs(value) or value == 0.0:
        arguments.append(f"abs={python_literal(float(max(tolerance, _LEAST_TOLERANCE)))}")
    elif tolerance > 0.0:
        arguments.append(f"rel=0.0, abs={python_literal(float(tolerance))}")
    return f"assert {place} == {call('pytest.approx', *arguments)}"


NO_STEP = (1.0, 0.0)
"""Between a unit and itself."""


@dataclass(frozen=True)
class Chain:
    """The conversions of a FieldAssignment.

    Args:
        map: The `bridge.AttributeMap`.
        assignment: The `bridge.FieldAssignment`.
        quantities: The quantities that the bridge states, by name.
    """

    map: bridge.AttributeMap
    assignment: bridge.FieldAssignment
    to_ros: bool
    quantities: Mapping[str, bridge.Quantity]
    unit_step: tuple[float, float]

    @property
    def sources(self) -> list[str]:
        """The source paths."""
        return [path.strip() for path in self.assignment.source.split(",")]

    @property
    def targets(self) -> list[str]:
        """The target paths."""
        return [path.strip() for path in self.assignment.target.split(",")]

    @cached_property
    def steps(self) -> list[Step]:
        """The conversions."""
        steps: list[Step] = []
        paths = self.sources
        for element in self.assignment.conversions:
            names = source_names(paths)
            step = step_of(element, names, to_ros=self.to_ros, quantities=self.quantities)
            steps.append(step)
            paths = [RESULT]
        return steps

    @property
    def is_numeric(self) -> bool:
        """Whether all conversions make one number of numbers."""
        return all(
            step.conversion.outputs == (NUMBER,)
            and {kind.rstrip("+") for kind in step.conversion.inputs} == {NUMBER}
            for step in self.steps
        )

    @property
    def leads_back(self) -> bool:
        """Whether each result comes from one number of the source alone."""
        return len(self.sources) == 1 and all(step.leads_back for step in self.steps)

    def results(self, values: Sequence[Any]) -> list[Any]:
        """Returns the results of the conversions for the values of the sources, in their units.

        Raises:
            NoValueError: They have no result.
        """
        current = list(values)
        for step in self.steps:
            current = step.forward(current)
        return current

    def forward(self, values: Sequence[float]) -> float | None:
        """Returns the result for the values of the sources; None when they have none."""
        try:
            current = self.results(values)
        except NoValueError:
            return None
        if len(current) != 1:
            return None
        factor, offset = self.unit_step
        return float(current[0] * factor + offset)

    def back(self, value: float) -> float:
        """Returns the value of the source that gives a value of the target."""
        factor, offset = self.unit_step
        value = (value - offset) / factor
        for step in reversed(self.steps):
            value = step.back(value)
        return value

    @property
    def has_unit_step(self) -> bool:
        """Whether the unit of the result is not that of the target."""
        return self.unit_step != NO_STEP


def quantities_of(owner: bridge.Bridge | None) -> dict[str, bridge.Quantity]:
    """Returns the quantities that a bridge states, by name."""
    return (
        {str(quantity.name): quantity for quantity in owner.quantities} if owner is not None else {}
    )
