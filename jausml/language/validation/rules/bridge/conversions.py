"""Rules about conversions and units."""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from typing import TypeAlias

from jausml.language.attributes.expressions import ExpressionError, occurrences, parse_expression
from jausml.language.attributes.units import UnitError, nearest_units, parse_unit
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Severity
from jausml.language.model.names import around
from jausml.language.semantics.assignments.steps import (
    ChainFault,
    chain_kinds,
    expression_names,
    value_of,
)
from jausml.language.semantics.assignments.units import (
    Measure,
    UnitFault,
    attribute_measure,
    measure,
    result_measure,
)
from jausml.language.semantics.conversions import (
    CONVERSIONS,
    ArgumentKind,
    Conversion,
    conversion_of,
)
from jausml.language.semantics.conversions.authored import Expression, User
from jausml.language.semantics.conversions.numbers import Square, SquareRoot
from jausml.language.semantics.paths.attributes import LIST, NUMBERS, Attribute
from jausml.language.semantics.paths.scopes import (
    Direction,
    Placed,
    carriers_of,
    directed,
    directions_of,
    maps_of,
)
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

WithChain: TypeAlias = "bridge.FieldAssignment | bridge.ListAssignment"
WithUnits: TypeAlias = (
    "jaus.FixedField | jaus.Alternative | ros.Field | bridge.Quantity | bridge.Conversion"
)

MOST_CONVERSIONS = 16
"""The most conversions of one value: they are generated as one expression."""

_METHOD = re.compile("[a-z][a-z0-9_]*")
_OWN_FEATURES = {
    argument.feature: conversion.name
    for conversion in CONVERSIONS.values()
    for argument in conversion.arguments
    if argument.kind is not ArgumentKind.NUMBER
}


@rule("JML414", "conversion used wrongly", kinds=bridge.Conversion)
def conversions(_: Subject, conversion: bridge.Conversion) -> Iterator[Finding]:
    """A conversion has the arguments, the inputs and the features that it needs.

    The first one takes the sources, each further one the result of the one before. A quantity of
    the map stands for the one argument of a conversion. `look_up` names a table of the map,
    `expression` has an expression, `user` a method, `with_units` units; no other conversion has.
    There are at most 16 in a row.

    Bad: `<conversions kind="scale"/>`, which takes a factor

    Good: `<conversions kind="scale"><arguments>0.1</arguments></conversions>`
    """
    yield from _feature_findings(conversion)
    yield from _argument_findings(conversion)


@conversions.also(Direction)
def _directed_conversions(_: Subject, direction: Direction) -> Iterator[Finding]:
    for placed in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment):
        yield from _chain_findings(placed)


@rule("JML441", "expression that cannot be computed", kinds=Direction)
def expressions(_: Subject, direction: Direction) -> Iterator[Finding]:
    """An expression is well-formed and uses known names: sources, functions, pi.

    A source is named by the last step of its path, by more of its last steps, or by its whole path;
    a single one is also `value`, and what the conversion before yields is `value` too. In a
    ListAssignment there are `index`, counted from 0, and `count`.

    Bad: `expression="hypot(x, z)"` with `source="linear.x, linear.y"`

    Good: `expression="hypot(x, y)"`
    """
    for placed in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment):
        for position, conversion in enumerate(placed.assignment.conversions):
            if conversion.kind.name == Expression.name and conversion.expression:
                yield from _expression_findings(placed, conversion, position)


@rule("JML446", "impossible method of a user conversion")
def user_methods(subject: Subject) -> Iterator[Finding]:
    """The method of a user conversion has a name that Python accepts and one number of inputs.

    The skeleton of the bridge has it as `convert_<method>`, once for all conversions of this name.

    Bad: `method="Speed limit"`

    Good: `method="speed_limit"`
    """
    known: dict[tuple[EObject | None, str], tuple[int, bridge.Conversion]] = {}
    for owner in directed(subject):
        for bridge_, conversion, inputs in _own_methods(directions_of(subject, owner)):
            name = str(conversion.method)
            if not _METHOD.fullmatch(name) or keyword.iskeyword(name):
                message = f"method {name!r} is no name of lower-case letters, digits and _"
                yield Finding(conversion, message, "method")
                continue
            count, first = known.setdefault((bridge_, name), (inputs, conversion))
            if count != inputs:
                message = f"method '{name}' takes {inputs} here, but {count} elsewhere"
                note = Note(first, f"'{name}' with {count}", "method")
                yield Finding(conversion, message, "method", related=(note,))


def _own_methods(
    directions: Iterable[Direction],
) -> list[tuple[EObject | None, bridge.Conversion, int]]:
    """Returns conversions by methods of users: the bridge, the conversion and how much it takes."""
    return [
        # Behind the first conversion there is one value.
        (direction.map.eContainer(), conversion, 1 if position else len(placed.sources))
        for direction in directions
        for placed in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment)
        for position, conversion in enumerate(placed.assignment.conversions)
        if conversion.kind.name == User.name and conversion.method
    ]


def _feature_findings(conversion: bridge.Conversion) -> Iterator[Finding]:
    name = conversion.kind.name
    for feature, owner in _OWN_FEATURES.items():
        value = getattr(conversion, feature)
        if value and name != owner:
            yield Finding(conversion, f"{name} has no {feature}", feature)
        elif not value and name == owner:
            yield Finding(conversion, f"{name} states no {feature}", "kind")
    owner_map = around(conversion, bridge.AttributeMap)
    for feature, element in (("table", conversion.table), ("quantity", conversion.quantity)):
        if element is not None and owner_map is not None and element.eContainer() is not owner_map:
            message = f"{feature} '{element.name}' belongs to another map"
            yield Finding(conversion, message, feature, f"add it to '{owner_map.name}'")


def _argument_findings(conversion: bridge.Conversion) -> Iterator[Finding]:
    name = conversion.kind.name
    wanted = [number.name for number in conversion_of(conversion).numbers]
    values = list(conversion.arguments)
    takes = f"takes {' and '.join(wanted)}" if wanted else "takes no arguments"
    if conversion.quantity is not None:
        if len(wanted) != 1 or values:
            message = f"{name} {takes}, no quantity" if len(wanted) != 1 else ""
            message = message or f"{name} has both a quantity and an argument"
            yield Finding(conversion, message, "quantity")
            return
        values = [conversion.quantity.value]
    if len(values) != len(wanted):
        message = f"{name} {takes}, {len(values)} given"
        yield Finding(conversion, message, "arguments" if conversion.arguments else None)
    elif conversion.quantity is None:
        fault = _value_fault(conversion_of(conversion), values)
        if fault:
            yield Finding(conversion, fault, "arguments")


def _value_fault(conversion: Conversion, values: list[float]) -> str:
    if not all(math.isfinite(value) for value in values):
        return f"{conversion.name} has an argument that is not finite"
    return conversion.fault(*values)


def _chain_findings(placed: Placed[WithChain]) -> Iterator[Finding]:
    assignment = placed.assignment
    attributes = placed.source_attributes
    is_list = isinstance(assignment, bridge.ListAssignment)
    unknown = any(
        not attribute.kind or (attribute.kind in (LIST, NUMBERS) and not is_list)
        for attribute in attributes
    )
    if not attributes or unknown:
        return
    if len(assignment.conversions) > MOST_CONVERSIONS:
        message = f"{len(assignment.conversions)} conversions, more than {MOST_CONVERSIONS}"
        yield Finding(assignment.conversions[MOST_CONVERSIONS], message, "kind")
        return
    if not assignment.conversions:
        if len(attributes) > 1:
            message = f"{len(attributes)} sources without a conversion that takes them"
            yield Finding(assignment, message, "source")
        return
    kinds = chain_kinds(assignment.conversions, [attribute.kind for attribute in attributes])
    if isinstance(kinds, ChainFault):
        yield Finding(kinds.conversion, kinds.message, "kind")
    elif is_list and kinds not in ([NUMBERS], ["any"]):
        message = f"{assignment.conversions[-1].kind.name} yields no list"
        yield Finding(assignment.conversions[-1], message, "kind")


def _expression_findings(
    placed: Placed[WithChain], conversion: bridge.Conversion, position: int
) -> Iterator[Finding]:
    try:
        expression = parse_expression(conversion.expression or "")
    except ExpressionError as error:
        yield Finding(conversion, f"expression: {error}", "expression")
        return
    known = expression_names(placed, position)
    unknown = next(
        (occurrence for occurrence in occurrences(expression) if occurrence.name not in known), None
    )
    if unknown is not None:
        yield Finding(
            conversion,
            f"expression: '{unknown.name}' is no source{f' at column {unknown.column}'}",
            "expression",
            _nearest(unknown.name, known),
        )


def _nearest(name: str, known: Iterable[str]) -> str:
    near = get_close_matches(name, known, n=1)
    short = [
        candidate
        for candidate in known
        if candidate and "." not in candidate and not re.fullmatch("value[0-9]+", candidate)
    ]
    return f"did you mean '{near[0]}'?" if near else f"there is {', '.join(short)}"


@rule("JML431", "units do not match", kinds=Direction)
def unit_mismatch(_: Subject, direction: Direction) -> Iterator[Finding]:
    """The result of an assignment measures the same quantity as its target.

    The unit of a field is its own or that of the field around it. Units of one dimension that
    differ in scale, such as degree and radian, are converted automatically; a length never becomes
    an angle. A conversion that needs a certain unit, such as wrap_angle, is given this unit. Where
    one end has no unit, or where scale, linear, an expression, a table or a method of the skeleton
    makes a number of the author's choice, nothing is reported; `with_units` states a unit there.

    Bad: `target="twist.linear.x" source="YawRate"`

    Good: `target="twist.angular.z" source="YawRate"` with the conversion negate
    """
    for placed in direction.of_kind(bridge.FieldAssignment):
        if placed.source_attributes and placed.target_attributes:
            yield from _mismatches(placed)


@rule(
    "JML432",
    "unknown unit",
    severity=Severity.WARNING,
    kinds=(jaus.FixedField, jaus.Alternative, ros.Field, bridge.Quantity, bridge.Conversion),
    needs=(),
)
def unknown_unit(_: Subject, element: WithUnits) -> Iterator[Finding]:
    """A unit is written in SI symbols or in the words of JAUS.

    An unknown unit is never compared with another one, so mistakes go unnoticed.

    Bad: `units="m/sec"`

    Good: `units="m/s"` or `units="meter per second"`
    """
    text = element.units
    if not text:
        return
    try:
        parse_unit(text)
    except UnitError as error:
        near = nearest_units(text)
        hint = f"did you mean {' or '.join(near)}?" if near else ""
        yield Finding(element, f"unit {text!r}: {error}", "units", hint)


@rule("JML445", "quantity used wrongly", kinds=bridge.Conversion)
def quantities(subject: Subject, conversion: bridge.Conversion) -> Iterator[Finding]:
    """A quantity of a bridge gives a value to one of the quantities of its maps.

    It has the name and the dimension of the quantity that it overrides, and a legal value for the
    conversions that refer to it: a maximum is above 0. Its unit may be another one, 30 km/h for a
    speed in m/s.

    Bad: a bridge with the quantity `max_sped`, whose maps have `max_speed`

    Good: a bridge with the quantity `max_speed`
    """
    quantity = conversion.quantity
    if quantity is None or not subject.is_read(quantity, ("value",)):
        return
    if fault := _quantity_fault(conversion, quantity, {}):
        note = Note(quantity, f"'{quantity.name}'", "value")
        yield Finding(conversion, fault, "quantity", related=(note,))


@quantities.also(bridge.Bridge)
def _quantities_bridge(_: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    carried = (used for carrier in carriers_of(owner) for used in maps_of(carrier))
    maps = tuple(dict.fromkeys((*owner.maps, *carried)))
    used = {quantity.name: quantity for map_ in maps for quantity in map_.quantities}
    for own in owner.quantities:
        yield from _override_findings(own, used, maps)


def _quantity_fault(
    conversion: bridge.Conversion,
    quantity: bridge.Quantity,
    overrides: dict[str, bridge.Quantity],
) -> str:
    """Returns why a conversion cannot take the value of a quantity; empty where it can."""
    known = conversion_of(conversion)
    value = value_of(quantity, overrides)
    fault = _value_fault(known, [value]) if len(known.numbers) == 1 else ""
    return f"'{quantity.name}' does not fit: {fault}" if fault else ""


def _override_findings(
    quantity: bridge.Quantity,
    used: dict[str, bridge.Quantity],
    maps: Iterable[bridge.AttributeMap],
) -> Iterator[Finding]:
    original = used.get(quantity.name)
    if original is None:
        known = f"they have {', '.join(map(str, used))}" if used else "take it away"
        message = f"no map of the bridge has the quantity '{quantity.name}'"
        yield Finding(quantity, message, "name", known)
        return
    own, other = measure(quantity.units or ""), measure(original.units or "")
    if own is not None and other is not None and not own.unit.is_compatible(other.unit):
        message = f"'{quantity.name}' is in {own.text}, but the map has it in {other.text}"
        note = Note(original, f"'{original.name}'", "units")
        yield Finding(quantity, message, "units", f"state it in {other.text}", (note,))
    faults = {
        _quantity_fault(element, element.quantity, {quantity.name: quantity})
        for map_ in maps
        for element in map_.eAllContents()
        if isinstance(element, bridge.Conversion) and element.quantity is not None
        if element.quantity.name == quantity.name
    }
    for fault in sorted(faults - {""}):
        yield Finding(quantity, fault, "value")


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
