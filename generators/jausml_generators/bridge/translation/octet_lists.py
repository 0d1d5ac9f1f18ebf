"""Lists of single octets on both sides, such as the cells of grids: a table translates them."""

from __future__ import annotations

from typing import TypeAlias

from jausml.language.cdr import PRIMITIVES
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.translation import expressions as values
from jausml_generators.bridge.translation.ros_fields import RosStart
from jausml_generators.bridge.translation.steps import Each, Octets, Write
from jausml_generators.python.codec.jaus_fields import JausStart
from jausml_generators.python.codec.members import PartValue

Start: TypeAlias = JausStart | RosStart

_OCTETS = frozenset("bB")


def octets(source: Start, target: Start) -> Octets | None:
    """Returns the octets of which elements of lists are made; None where one side has none."""
    if not (_is_octet(source) and _is_octet(target)):
        return None
    if isinstance(target, JausStart) and isinstance(target.value, PartValue):
        return Octets(record=target.value.python_type)
    return Octets(record="")


def _is_octet(start: Start) -> bool:
    if isinstance(start, JausStart):
        return isinstance(start.value, PartValue) and bool(start.value.part.octet)
    if not isinstance(start.field, ros.PrimitiveField):
        return False
    primitive = PRIMITIVES.get(start.field.type.name)
    return primitive is not None and primitive.code in _OCTETS


def octet_limit(step: Each) -> values.Limit | None:
    """Returns the limit of the only value of elements that are octets on both sides.

    It has a conversion of the octet alone; None where more is done.
    """
    if step.octets is None or len(step.steps) != 1:
        return None
    (only,) = step.steps
    if not isinstance(only, Write) or not isinstance(only.value, values.Limit):
        return None
    limit = only.value
    conversion = limit.value
    if limit.how != "integer" or limit.drops_field or not isinstance(conversion, values.Convert):
        return None
    (operand,) = conversion.inputs if len(conversion.inputs) == 1 else (None,)
    # Casts to real change no octet, and the table has the result of each.
    while isinstance(operand, values.Cast):
        operand = operand.value
    is_plain = isinstance(operand, values.Read) and operand.place.root == step.item
    return limit if is_plain and not conversion.arguments and conversion.near is None else None
