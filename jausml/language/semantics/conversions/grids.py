"""Conversions of grids and their cells, computed here in whole fractions."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from jausml.language.semantics.conversions.conversion import (
    Conversion,
    Definition,
    NoArithmetic,
    NoValueError,
    UnitEffect,
)
from jausml.language.semantics.paths.attributes import NUMBER, NUMBERS

if TYPE_CHECKING:
    from collections.abc import Sequence

_UNKNOWN_OCCUPANCY, _LARGEST_OCCUPANCY = -1, 100
_UNKNOWN_COST, _LARGEST_COST = 255, 254


class OccupancyToCost(Conversion):
    """Occupancy of nav_msgs/OccupancyGrid to the cost of a JAUS cost map.

    Occupancy is 0..100, -1 for unknown; cost is 0..254, 255 for unknown.
    """

    name = "occupancy_to_cost"
    limits = ((0.0, 255.0),)
    definition = Definition(
        "value",
        "if(value == -1, 255, round(value * (254 / 100)))",
        refused="not (value == -1 or value >= 0 and value <= 100)",
        reason="is no occupancy",
    )

    def forward(self, value: float) -> float:
        """The nearest cost."""
        if value == _UNKNOWN_OCCUPANCY:
            return _UNKNOWN_COST
        return _part(self.name, value, _LARGEST_OCCUPANCY, _LARGEST_COST)

    def loses(self, value: float) -> bool:
        """Whether it is unknown."""
        return value == _UNKNOWN_OCCUPANCY


class CostToOccupancy(Conversion):
    """Cost of a JAUS cost map to the occupancy of nav_msgs/OccupancyGrid.

    Cost is 0..254, 255 for unknown; occupancy is 0..100, -1 for unknown.
    """

    name = "cost_to_occupancy"
    limits = ((-1.0, 100.0),)
    definition = Definition(
        "value",
        "if(value == 255, -1, round(value / (254 / 100)))",
        refused="not (value >= 0 and value <= 255)",
        reason="is no cost",
    )

    def forward(self, value: float) -> float:
        """The nearest occupancy."""
        if value == _UNKNOWN_COST:
            return _UNKNOWN_OCCUPANCY
        # A float just below 255 is a cost too.
        return _part(self.name, value, _LARGEST_COST, _LARGEST_OCCUPANCY, _UNKNOWN_COST)

    def loses(self, value: float) -> bool:
        """Whether it is unknown."""
        return value == _UNKNOWN_COST


class ReverseRows(Conversion):
    """Numbers of a grid, row by row, with the rows in the opposite order.

    The second value is the number of columns.
    """

    name = "reverse_rows"
    inputs = (NUMBERS, NUMBER)
    outputs = (NUMBERS,)
    units = UnitEffect.SAME
    definition = NoArithmetic.ORDER

    def forward(self, cells: Sequence[float], columns: float) -> list[float]:
        """The rows from the last to the first."""
        if not cells:
            return []
        if not math.isfinite(columns) or columns < 1 or columns != int(columns):
            raise NoValueError(self.name)
        rows: list[list[float]] = [[] for _ in range(math.ceil(len(cells) / columns))]
        for index, cell in enumerate(cells):
            rows[index // int(columns)].append(cell)
        if len(rows[-1]) != columns:
            raise NoValueError(self.name)
        return [cell for row in reversed(rows) for cell in row]


def _part(name: str, value: float, largest: int, other: int, end: float | None = None) -> float:
    """The nearest integer to the same part of another range, the even one of two."""
    if not 0 <= value <= largest and not (end is not None and largest < value < end):
        raise NoValueError(name)
    return float(round(Fraction(value) * other / largest))


CONVERSIONS = (OccupancyToCost(), CostToOccupancy(), ReverseRows())
