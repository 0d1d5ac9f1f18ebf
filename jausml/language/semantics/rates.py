"""Rates: quantities of which zero is standstill, such as velocities."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.attributes import (
    BOOL,
    NUMBER,
    NUMBERS,
    TEXT,
    TIME,
    TIME_STAMP,
    Attribute,
)
from jausml.language.semantics.jaus_paths import JausPlace
from jausml.language.semantics.paths import outer_scope, source_paths, target_paths
from jausml.language.semantics.ros_paths import RosPlace
from jausml.language.semantics.units import measure

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.attributes.units import Unit

_NUMERIC = (NUMBER, NUMBERS)
_WITHOUT_NUMBERS = (BOOL, TEXT, TIME, TIME_STAMP)


def fills_rates_alone(used: bridge.AttributeMap, *, to_ros: bool) -> bool:
    """Tells whether each number that a map fills is a rate, so that zeros stop what it commands.

    A map that fills a number of unknown unit, or none, does not.
    """
    found = list(_units(used, to_ros=to_ros))
    return bool(found) and all(each is not None and is_rate(each) for each in found)


def is_rate(unit: Unit) -> bool:
    """Tells whether a unit is that of a change in time: m/s, rad/s, and 1/s."""
    return dict(unit.dimension).get("s") == Fraction(-1)


def _units(used: bridge.AttributeMap, *, to_ros: bool) -> Iterator[Unit | None]:
    """Yields the unit of each number that is filled: that of the target, else of its source.

    Of lists, and of wholes of numbers such as an orientation, it is none.
    """
    scope = outer_scope(used, to_ros=to_ros)
    for each in used.toRos if to_ros else used.toJaus:
        if isinstance(each, bridge.ListAssignment):
            yield None
        if not isinstance(each, bridge.FieldAssignment):
            continue
        sources = [scope.find_source(path) for path in source_paths(each)]
        known = next(filter(None, (_unit(_attribute(place)) for place in sources)), None)
        for path in target_paths(each):
            found = _attribute(scope.find_target(path))
            if found is None or found.kind not in (*_NUMERIC, *_WITHOUT_NUMBERS):
                yield None
            elif found.kind in _NUMERIC:
                yield _unit(found) or known


def _attribute(place: object) -> Attribute | None:
    return place.attribute() if isinstance(place, JausPlace | RosPlace) else None


def _unit(found: Attribute | None) -> Unit | None:
    known = measure(found.units) if found is not None else None
    return known.unit if known is not None else None
