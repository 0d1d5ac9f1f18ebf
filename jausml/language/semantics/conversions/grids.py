"""Conversions of grids and their cells."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.semantics.conversions.conversion import Conversion, NoValueError, UnitEffect
from jausml.language.semantics.conversions.definition import Definition, NoArithmetic
from jausml.language.semantics.paths.attributes import NUMBER, NUMBERS

if TYPE_CHECKING:
    from collections.abc import Sequence

_UNKNOWN_OCCUPANCY, _UNKNOWN_COST = -1, 255


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
