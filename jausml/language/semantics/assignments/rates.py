"""Rates, such as velocities, which a zero stops."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from jausml.language.attributes.units import Unit
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.units import NUMERIC, measure
from jausml.language.semantics.paths import attributes
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import (
    outer_scope,
    source_paths,
    spelled_out,
    target_paths,
)

_WITHOUT_NUMBERS = (attributes.BOOL, attributes.TEXT, attributes.TIME, attributes.TIME_STAMP)


def fills_rates_alone(map_: bridge.AttributeMap, *, to_ros: bool) -> bool:
    """Tells whether each number that a map fills is a rate, so that zeros are its stop.

    A map that fills a number of unknown unit, or none, does not.
    """
    units = list(_units(map_, to_ros=to_ros))
    return bool(units) and all(unit is not None and _is_rate(unit) for unit in units)


def _is_rate(unit: Unit) -> bool:
    """Tells whether a unit is one per second: m/s, rad/s, kg/s and Hz, but not m/s^2."""
    return dict(unit.dimension).get("s") == Fraction(-1)


def _units(map_: bridge.AttributeMap, *, to_ros: bool) -> Iterator[Unit | None]:
    """Yields the unit of each number with an assignment: of the target, else of the source.

    Of lists, and of wholes of numbers such as an orientation, it is none.
    """
    scope = outer_scope(map_, to_ros=to_ros)
    for assignment in spelled_out(map_, to_ros=to_ros):
        if isinstance(assignment, bridge.ListAssignment):
            yield None
        if not isinstance(assignment, bridge.FieldAssignment):
            continue
        sources = [scope.find_source(path) for path in source_paths(assignment)]
        known = next(filter(None, (_known_unit(_attribute(place)) for place in sources)), None)
        for path in target_paths(assignment):
            attribute = _attribute(scope.find_target(path))
            if attribute is None or attribute.kind not in (*NUMERIC, *_WITHOUT_NUMBERS):
                yield None
            elif attribute.kind in NUMERIC:
                yield _known_unit(attribute) or known


def _attribute(place: object) -> attributes.Attribute | None:
    return place.attribute() if isinstance(place, JausPlace | RosPlace) else None


def _known_unit(attribute: attributes.Attribute | None) -> Unit | None:
    known = measure(attribute.units) if attribute is not None else None
    return known.unit if known is not None else None
