"""Conversions of grids and their cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from .types import ConversionError

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "cost_to_occupancy",
    "occupancy_to_cost",
    "reverse_rows",
]

Cell = TypeVar("Cell")

_UNKNOWN_OCCUPANCY = -1.0
_UNKNOWN_COST = 255.0
_COST_PER_OCCUPANCY = 254.0 / 100.0


def occupancy_to_cost(value: float) -> float:
    """Occupancy 0..100, -1 for unknown (nav_msgs/OccupancyGrid), to cost 0..254, 255 for unknown.

    Raises:
        ConversionError: The value is no occupancy.
    """
    if value == _UNKNOWN_OCCUPANCY:
        return _UNKNOWN_COST
    if not 0.0 <= value <= 100.0:
        raise ConversionError(f"{value} is no occupancy")
    return float(round(value * _COST_PER_OCCUPANCY))


def cost_to_occupancy(value: float) -> float:
    """Cost 0..254, 255 for unknown, to occupancy 0..100, -1 for unknown (nav_msgs/OccupancyGrid).

    Raises:
        ConversionError: The value is no cost.
    """
    if value == _UNKNOWN_COST:
        return _UNKNOWN_OCCUPANCY
    if not 0.0 <= value < _UNKNOWN_COST:
        raise ConversionError(f"{value} is no cost")
    return float(round(value / _COST_PER_OCCUPANCY))


def reverse_rows(cells: Sequence[Cell], columns: float) -> list[Cell]:
    """The cells of a grid, row by row, with the rows in the opposite order.

    Raises:
        ConversionError: The cells do not fill rows of `columns` cells.
    """
    starts = row_starts(len(cells), columns)
    return [cell for start in starts for cell in cells[start : start + int(columns)]]


def row_starts(count: int, columns: float) -> range:
    """Returns where the rows of a grid begin, the last row first.

    Raises:
        ConversionError: The cells do not fill rows of `columns` cells.
    """
    if not count:
        return range(0)
    if not (columns >= 1.0 and columns % 1.0 == 0.0 and count % columns == 0.0):
        raise ConversionError(f"{count} cells do not fill rows of {columns}")
    return range(count - int(columns), -1, -int(columns))
