"""Values of quantities of maps, which a bridge may state in a unit of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.attributes.units import UnitError, conversion_between, parse_unit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel.classes import bridge


def value_of(quantity: bridge.Quantity, overrides: Mapping[str, bridge.Quantity]) -> float:
    """Returns the value of a quantity of a map, in the unit that the map states.

    Args:
        overrides: The quantities of the bridge by name. One that has another unit of the same
            dimension is converted: 30 km/h is 8.333 m/s.
    """
    stated = overrides.get(str(quantity.name))
    if stated is None:
        return float(quantity.value)
    if not stated.units or not quantity.units or stated.units == quantity.units:
        return float(stated.value)
    try:
        own, wanted = parse_unit(stated.units), parse_unit(quantity.units)
    except UnitError:
        return float(stated.value)
    if not own.is_compatible(wanted):
        return float(stated.value)
    factor, offset = conversion_between(own, wanted)
    return float(stated.value) * factor + offset
