"""Rules about units: of fields, of quantities, and along the conversions of an assignment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.attributes.units import UnitError, nearest_units, parse_unit
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.units import (
    Measure,
    UnitFault,
    attribute_measure,
    measure,
    result_measure,
)
from jausml.language.semantics.conversions import conversion_of
from jausml.language.semantics.conversions.conversion import MAXIMUM
from jausml.language.semantics.conversions.numbers import Square, SquareRoot
from jausml.language.semantics.paths.attributes import Attribute
from jausml.language.semantics.paths.directions import directions
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.paths.scopes import Placed
    from jausml.language.semantics.subject import Subject

    WithUnits = jaus.FixedField | jaus.Alternative | ros.Field | bridge.Quantity | bridge.Conversion


@rule("JML431", Severity.ERROR, "units do not match")
def unit_mismatch(subject: Subject) -> Iterator[Finding]:
    """The result of an assignment measures the same quantity as its target.

    The unit of a field is its own or that of the field around it. Units of one dimension that
    differ in scale, such as degree and radian, are converted automatically; a length never becomes
    an angle. A conversion that needs a certain unit, such as wrap_angle, is given this unit. Where
    one end has no unit, or where scale, linear, an expression, a table or a method of the skeleton
    makes a number of the author's choice, nothing is reported; `with_units` states a unit there.

    Bad: `target="twist.linear.x" source="YawRate"`

    Good: `target="twist.angular.z" source="YawRate"` with the conversion negate
    """
    for direction in directions(subject):
        for placed in direction.of_kind(bridge.FieldAssignment):
            if placed.source_attributes and placed.target_attributes:
                yield from _mismatches(placed)


@rule("JML432", Severity.WARNING, "unknown unit")
def unknown_unit(subject: Subject) -> Iterator[Finding]:
    """A unit is written in SI symbols or in the words of JAUS.

    An unknown unit is never compared with another one, so mistakes go unnoticed.

    Bad: `units="m/sec"`

    Good: `units="m/s"` or `units="meter per second"`
    """
    kinds: tuple[type[WithUnits], ...] = (
        *(jaus.FixedField, jaus.Alternative),
        *(ros.Field, bridge.Quantity, bridge.Conversion),
    )
    for element in (each for kind in kinds for each in subject.instances(kind, needs=())):
        text = element.units
        if not text:
            continue
        try:
            parse_unit(text)
        except UnitError as error:
            near = nearest_units(text)
            hint = f"did you mean {' or '.join(near)}?" if near else ""
            yield Finding(element, f"unit {text!a}: {error}", "units", hint)


@rule("JML445", Severity.ERROR, "quantity used wrongly")
def quantities(subject: Subject) -> Iterator[Finding]:
    """A quantity of a bridge gives a value to one of the quantities of its maps.

    It has the name and the dimension of the quantity that it overrides, and a legal value for the
    conversions that refer to it: a maximum is above 0. Its unit may be another one, 30 km/h for a
    speed in m/s.

    Bad: a bridge with the quantity `max_sped`, whose maps have `max_speed`

    Good: a bridge with the quantity `max_speed`
    """
    for conversion in subject.instances(bridge.Conversion):
        quantity = conversion.quantity
        if quantity is None or quantity.value > 0:
            continue
        if tuple(conversion_of(conversion).arguments) == (MAXIMUM,):
            message = f"the maximum '{quantity.name}' is {quantity.value:g}, which is not above 0"
            note = Note(quantity, f"'{quantity.name}'", "value")
            yield Finding(conversion, message, "quantity", related=(note,))
    for owner in subject.instances(bridge.Bridge):
        used = _used_quantities(owner)
        for own in owner.quantities:
            yield from _override_findings(own, used)


def _used_quantities(owner: bridge.Bridge) -> dict[str, bridge.Quantity]:
    referred: list[bridge.AttributeMap | None] = [each.map for each in owner.bridgeConnections]
    for call in owner.serviceConnections:
        referred += [call.request, call.response]
    maps = [*owner.maps, *(each for each in referred if each is not None)]
    return {quantity.name: quantity for each in maps for quantity in each.quantities}


def _override_findings(
    quantity: bridge.Quantity, used: dict[str, bridge.Quantity]
) -> Iterator[Finding]:
    original = used.get(quantity.name)
    if original is None:
        known = f"they have {', '.join(map(str, used))}" if used else "they have none"
        message = f"no map of the bridge has the quantity '{quantity.name}'"
        yield Finding(quantity, message, "name", known)
        return
    own, other = measure(quantity.units or ""), measure(original.units or "")
    if own is not None and other is not None and not own.unit.is_compatible(other.unit):
        message = f"'{quantity.name}' is in {own.text}, but the map has it in {other.text}"
        note = Note(original, f"'{original.name}'", "units")
        yield Finding(quantity, message, "units", f"state it in {other.text}", (note,))


def _mismatches(placed: Placed[bridge.FieldAssignment]) -> Iterator[Finding]:
    result = result_measure(placed)
    if isinstance(result, UnitFault):
        yield Finding(result.element, result.message, "kind", result.hint)
        return
    if result is None:
        return
    factors = set()
    for path, target in placed.targets:
        wanted = attribute_measure(target)
        if wanted is None or not isinstance(target, Attribute):
            continue
        if not wanted.unit.is_compatible(result.unit):
            yield _mismatch(placed, path, result, wanted)
            return
        factors.add((wanted.unit.factor, wanted.unit.offset))
    if len(factors) > 1:
        message = f"the targets '{placed.assignment.target}' have different units"
        yield Finding(placed.assignment, message, "target")


def _mismatch(
    placed: Placed[bridge.FieldAssignment], path: str, result: Measure, wanted: Measure
) -> Finding:
    assignment = placed.assignment
    verb = "gives" if assignment.conversions else "is in"
    message = f"'{assignment.source}' {verb} {result.text}, but '{path}' is in {wanted.text}"
    hint = ""
    if wanted.unit.squared() == result.unit:
        hint = f"convert it by {SquareRoot.name}"
    elif wanted.unit == result.unit.squared():
        hint = f"convert it by {Square.name}"
    return Finding(assignment, message, "target", hint)
