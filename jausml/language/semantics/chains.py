"""Kinds of values along the conversions of an assignment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.semantics.attributes import BOOL, LIST, NUMBER, NUMBERS, TEXT, Attribute
from jausml.language.semantics.conversions import ANY, VALUE, conversion_of
from jausml.language.semantics.conversions.authored import Expression

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.metamodel.classes import bridge

_VALUES = (NUMBER, BOOL, TEXT)


@dataclass(frozen=True, slots=True)
class ChainFault:
    """The conversion of a chain that cannot take what it gets."""

    conversion: bridge.Conversion
    message: str


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
    """Tells whether what a conversion yields goes to a target."""
    if kind == ANY:
        return True
    if kind == VALUE:
        return target.kind in _VALUES
    # The truth of an expression is 1 or 0, which a bool takes.
    is_truth = isinstance(conversion_of(conversion), Expression) and target.kind == BOOL
    return kind == target.kind or is_truth
