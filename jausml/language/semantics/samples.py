"""Numbers sent through the conversions of an assignment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.attributes import NUMBER
from jausml.language.semantics.conversions import VALUE, NoValueError
from jausml.language.semantics.steps import steps_of
from jausml.language.semantics.units import result_step

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge
    from jausml.language.semantics.paths import Placed

__all__ = ["NoValueError", "sent_through"]


def sent_through(placed: Placed[bridge.FieldAssignment], value: float) -> float:
    """Returns what an assignment with one source and one target makes of a number.

    Raises:
        NoValueError: A conversion is not one of numbers, or limits this number.
    """
    for step in steps_of(placed):
        if step.conversion.outputs not in ((NUMBER,), (VALUE,)) or step.loses([value]):
            raise NoValueError(step.name)
        (result,) = step.forward([value])
        if not isinstance(result, float | int):
            raise NoValueError(step.name)
        value = result
    factor, offset = result_step(placed) or (1.0, 0.0)
    return value * factor + offset
