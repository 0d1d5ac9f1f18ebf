"""The conversions of an assignment, computed by the toolchain: figures of the generated tests."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from jausml.language.attributes.expressions import source_names
from jausml.language.semantics.assignments.steps import Step, step_of
from jausml.language.semantics.conversions import NoValueError
from jausml.language.semantics.paths.attributes import NUMBER

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.language.metamodel.classes import bridge

_VALUE = "."

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
        found: list[Step] = []
        paths = self.sources
        for element in self.assignment.conversions:
            names = source_names(paths)
            step = step_of(element, names, to_ros=self.to_ros, quantities=self.quantities)
            found.append(step)
            paths = [_VALUE] * len(step.conversion.outputs)
        return found

    @property
    def is_numeric(self) -> bool:
        """Whether all conversions make one number of numbers."""
        return all(
            step.conversion.outputs == (NUMBER,)
            and {each.rstrip("+") for each in step.conversion.inputs} == {NUMBER}
            for step in self.steps
        )

    @property
    def leads_back(self) -> bool:
        """Whether each result comes from one number of the source alone."""
        return len(self.sources) == 1 and all(each.leads_back for each in self.steps)

    def results(self, values: Sequence[Any]) -> list[Any]:
        """Returns what the conversions make of the values of the sources, before other units.

        Raises:
            NoValueError: They have no result.
        """
        current = list(values)
        for step in self.steps:
            current = step.forward(current)
        return current

    def forward(self, values: Sequence[float]) -> float | None:
        """Returns what becomes of the values of the sources; None when they have no result."""
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
    return {str(each.name): each for each in owner.quantities} if owner is not None else {}
