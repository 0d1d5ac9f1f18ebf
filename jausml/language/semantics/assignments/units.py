"""Units along assignments: of sources, of what conversions make of them, and of targets."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from jausml.language.attributes.units import Unit, UnitError, conversion_between, parse_unit
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.conversions import UnitEffect, conversion_of
from jausml.language.semantics.conversions.conversion import OWN
from jausml.language.semantics.conversions.numbers import Linear, Scale
from jausml.language.semantics.paths import attributes
from jausml.language.semantics.paths.scopes import Placed, place
from jausml.language.semantics.subject import remembered

NUMERIC = (attributes.NUMBER, attributes.NUMBERS)
"""Kinds of attributes that may have a unit."""

_OF_ONE_UNIT = (UnitEffect.SAME, UnitEffect.SQUARE, UnitEffect.ROOT)


@dataclass(frozen=True, slots=True)
class Measure:
    """A unit that is known."""

    text: str
    unit: Unit


@dataclass(frozen=True, slots=True)
class UnitFault:
    """Units of an assignment that do not go together."""

    element: EObject
    message: str
    hint: str = ""


def measure(text: str) -> Measure | None:
    """Returns the unit that a text names, None when it names none or is empty."""
    unit = _unit(text)
    return Measure(text, unit) if unit is not None else None


def unit_step(
    attribute_map: bridge.AttributeMap, assignment: bridge.FieldAssignment, *, to_ros: bool
) -> tuple[float, float] | None:
    """Returns the factor and offset from the result of the conversions to the unit of the target.

    Returns:
        Factor and offset; None when nothing is to be done, because the units are the same or one
        of them is not known.
    """
    placed = place(attribute_map, assignment, to_ros=to_ros)
    return result_step(placed) if placed is not None else None


def result_step(placed: Placed[bridge.FieldAssignment]) -> tuple[float, float] | None:
    """Returns the factor and offset of an assignment with its places, as `unit_step` does."""
    result = result_measure(placed)
    if not isinstance(result, Measure):
        return None
    for _, target in placed.targets:
        wanted = attribute_measure(target)
        if wanted is None or not wanted.unit.is_compatible(result.unit):
            continue
        step = conversion_between(result.unit, wanted.unit)
        return step if step != (1.0, 0.0) else None
    return None


@remembered
def result_measure(placed: Placed[bridge.FieldAssignment]) -> Measure | UnitFault | None:
    """Returns the unit in which the last conversion of an assignment yields its result.

    Returns:
        None when nothing is known, a fault when a conversion cannot take what it gets.
    """
    measures = [attribute_measure(source) for _, source in placed.sources]
    fault = _source_fault(
        placed, [source_measure for source_measure in measures if source_measure is not None]
    )
    if fault is not None:
        return fault
    current = _common(measures)
    for conversion in placed.assignment.conversions:
        result = _converted(conversion, current)
        if isinstance(result, UnitFault):
            return result
        current = result
    return current


@remembered
def units_clash(placed: Placed[bridge.FieldAssignment]) -> bool:
    """Tells whether an assignment changes the quantity, so that axes and ranges are lost."""
    result = result_measure(placed)
    if not isinstance(result, Measure):
        # A fault is a clash of units; None says that nothing is known.
        return result is not None
    wanted = [attribute_measure(target) for _, target in placed.targets]
    return any(
        target_measure is not None and not target_measure.unit.is_compatible(result.unit)
        for target_measure in wanted
    )


def attribute_measure(attribute: attributes.Found) -> Measure | None:
    """Returns the unit at the end of a path, when it is a number with a known one."""
    if isinstance(attribute, attributes.Attribute) and attribute.kind in NUMERIC:
        return measure(attribute.units)
    return None


def _source_fault(placed: Placed[bridge.FieldAssignment], known: list[Measure]) -> UnitFault | None:
    """Returns the fault of several sources, which a conversion takes in one unit."""
    first = next(iter(placed.assignment.conversions), None)
    if first is None or len(placed.sources) < 2:
        return None
    effect = conversion_of(first).units
    if isinstance(effect, tuple):
        results = (_between(first, source_measure, *effect) for source_measure in known)
        faults = (result for result in results if isinstance(result, UnitFault))
        # Without the hint: the conversion that it puts before takes one source alone.
        return next((UnitFault(first, fault.message) for fault in faults), None)
    if effect in _OF_ONE_UNIT and len({source_measure.unit for source_measure in known}) > 1:
        units = " and ".join(dict.fromkeys(source_measure.text for source_measure in known))
        return UnitFault(first, f"{first.kind.name} takes one unit, but gets {units}")
    return None


def _common(measures: list[Measure | None]) -> Measure | None:
    """The unit of several sources, when all have the same."""
    first = measures[0] if measures else None
    same = first is not None and all(source and source.unit == first.unit for source in measures)
    return first if same else None


def _converted(
    conversion: bridge.Conversion, current: Measure | None
) -> Measure | UnitFault | None:
    effect = conversion_of(conversion).units
    if isinstance(effect, tuple):
        return _between(conversion, current, *effect)
    if effect is UnitEffect.STATED:
        return measure(conversion.units or "")
    if current is None or effect not in _OF_ONE_UNIT:
        return None
    if effect is UnitEffect.SQUARE:
        return Measure(f"({current.text})^2", current.unit.squared())
    if effect is UnitEffect.ROOT:
        return Measure(f"square root of {current.text}", current.unit.root())
    return current


def _between(
    conversion: bridge.Conversion, current: Measure | None, taken: str, result_unit: str
) -> Measure | UnitFault | None:
    """The result of a conversion that takes one unit and gives another."""
    quantity = conversion.quantity
    own = measure(quantity.units or "") if quantity is not None else None
    wanted = own if taken == OWN else measure(taken)
    if current is not None and wanted is not None and current.unit != wanted.unit:
        return _unexpected(conversion, current, wanted)
    if result_unit == OWN:
        return current if own is None and taken == OWN else own
    return measure(result_unit)


def _unexpected(conversion: bridge.Conversion, current: Measure, wanted: Measure) -> UnitFault:
    name = conversion.kind.name
    if conversion.quantity is not None and wanted.text == conversion.quantity.units:
        message = f"{name} compares {current.text} with '{conversion.quantity.name}' in"
        message += f" {wanted.text}"
        return UnitFault(conversion, message, f"state the quantity in {current.text}")
    message = f"{name} takes {wanted.text}, but gets {current.text}"
    if not current.unit.is_compatible(wanted.unit):
        return UnitFault(conversion, message)
    factor, offset = conversion_between(current.unit, wanted.unit)
    step = f"{Linear.name}({factor:.17g}, {offset:.17g})"
    step = step if offset else f"{Scale.name}({factor:.17g})"
    return UnitFault(conversion, message, f"convert it before, by {step}")


@lru_cache(maxsize=1024)
def _unit(text: str) -> Unit | None:
    try:
        return parse_unit(text) if text else None
    except UnitError:
        return None
