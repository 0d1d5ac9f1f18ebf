"""Columns of numbers that numpy goes through at once, for translations from bytes to bytes.

What comes out is what the conversions and limits make of each number, to the last bit: numpy does
the arithmetic, which IEEE 754 fixes, and the functions of `math` do the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Column: TypeAlias = NDArray[numpy.float64]


def limited(values: Column, lower: float, upper: float, limit: Callable[[float], float]) -> Column:
    """Asks a limit for those that do not fit, in order; returns all.

    Args:
        values: The numbers, which are changed.
        lower: Least value that fits.
        upper: Greatest value that fits.
        limit: Makes a number of one that does not fit, or raises OutOfRangeError.
    """
    for index in numpy.flatnonzero(~((values >= lower) & (values <= upper))).tolist():
        values[index] = limit(values[index].item())
    return values
