"""Columns of numbers that numpy goes through at once, for translations from bytes to bytes.

What comes out is what the conversions and limits make of each number, to the last bit: numpy does
the arithmetic, which IEEE 754 fixes, and the functions of `math` do the others. What a conversion
treats in another way than most numbers is not a number in all that comes out, and so fits nothing.
"""

from __future__ import annotations

import math
from itertools import repeat
from typing import TYPE_CHECKING, TypeAlias

import numpy

from ..base.errors import JausError
from . import stamps

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from .types import TimeLike

    Column: TypeAlias = NDArray[numpy.float64]
    Part: TypeAlias = "Column | float"
    """A column, or what is the same in all of it."""

# Closer to vertical than this, roll and yaw turn about the same axis.
_VERTICAL = 1.0 - 1e-12


# ------------------------------------------------------------------ limits


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


def fit(values: Column, lower: float, upper: float) -> bool:
    """Whether all values are within lower .. upper; what is no number is not."""
    least: float = numpy.minimum.reduce(values, None).item()
    greatest: float = numpy.maximum.reduce(values, None).item()
    return lower <= least and greatest <= upper


# ------------------------------------------------------------------ angles


def wrap_angle(values: Column) -> Column:
    """The same directions in [-pi, pi]."""
    if fit(values, -math.pi, math.pi):
        return values
    if not fit(values, -math.inf, math.inf) or numpy.isinf(values).any():
        return values * math.nan
    return _column([*map(math.remainder, values.tolist(), repeat(math.tau))])


def frd_angles_to_flu_quaternion(roll: Column, pitch: Column, yaw: Column) -> Sequence[Part]:
    """The rotations about x by roll, then about y by -pitch, then about z by -yaw."""
    return _from_angles(roll, -pitch, -yaw)


def ned_angles_to_enu_quaternion(roll: Column, pitch: Column, heading: Column) -> Sequence[Part]:
    """The same as of yaw, which is a quarter turn less the heading."""
    return _from_angles(roll, -pitch, math.pi / 2 - heading)


def flu_quaternion_to_frd_angles(
    x: Column, y: Column, z: Column, w: Column
) -> tuple[Column, Column, Column]:
    """Rolls, pitches and yaws about forward-right-down axes.

    If one quaternion points up or down, is of length zero or has what is no number, none of the
    results is a number.
    """
    y, z = -y, -z
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    sines: list[float] = (2 * (w * y - z * x) / (xx + yy + zz + ww)).tolist()
    # Where one is not a number, its pitch is none either, whatever is found of the others.
    if min(sines) < -_VERTICAL or max(sines) > _VERTICAL:
        none = x * math.nan
        return none, none, none
    try:
        pitch = numpy.fromiter(map(math.asin, sines), "<f8", len(sines))
    except ValueError:
        pitch = x * math.nan
    roll = _directions(2 * (w * x + y * z), ww - xx - yy + zz)
    yaw = _directions(2 * (w * z + x * y), ww + xx - yy - zz)
    return roll, pitch, yaw


def enu_quaternion_to_ned_angles(
    x: Column, y: Column, z: Column, w: Column
) -> tuple[Column, Column, Column]:
    """Rolls, pitches and headings in north-east-down of orientations in east-north-up."""
    roll, pitch, yaw = flu_quaternion_to_frd_angles(x, y, z, w)
    return roll, pitch, wrap_angle(math.pi / 2 + yaw)


def _directions(y: Column, x: Column) -> Column:
    return numpy.fromiter(map(math.atan2, y.tolist(), x.tolist()), "<f8", len(y))


def _from_angles(roll: Column, pitch: Column, yaw: Column) -> Sequence[Part]:
    """The rotations about x by roll, then about y by pitch, then about z by yaw."""
    try:
        (sr, cr), (sp, cp), (sy, cy) = map(_sines_and_cosines, (roll, pitch, yaw))
    except ValueError:  # of an infinite angle
        return (math.nan,) * 4
    level, upright, sides, both = sr * cp, cr * cp, cr * sp, sr * sp
    return (
        level * cy - sides * sy,
        sides * cy + level * sy,
        upright * sy - both * cy,
        upright * cy + both * sy,
    )


def _sines_and_cosines(angles: Column) -> tuple[Part, Part]:
    """Returns sines and cosines of half of the angles; one of each where all are the same."""
    halves: list[float] = (angles / 2).tolist()
    first, count = halves[0], len(halves)
    # Zeros with different signs are not the same.
    if first and halves.count(first) == count:
        return math.sin(first), math.cos(first)
    sines = numpy.fromiter(map(math.sin, halves), "<f8", count)
    return sines, numpy.fromiter(map(math.cos, halves), "<f8", count)


def _column(values: list[float]) -> Column:
    return numpy.array(values)


# ------------------------------------------------------------------ time stamps


def time_of(bits: Column, near: TimeLike) -> tuple[Column, Column]:
    """Seconds and nanoseconds of time stamps of JAUS; no numbers if one is no time of day."""
    numbers = [*map(int, bits.tolist())]
    try:
        known = {each: stamps.time_of(each, near) for each in set(numbers)}
    except JausError:
        none = bits * math.nan
        return none, none
    seconds, nanoseconds = zip(*map(known.__getitem__, numbers), strict=True)
    return numpy.array(seconds, "<f8"), numpy.array(nanoseconds, "<f8")


def bits_of(seconds: Column, nanoseconds: Column) -> Column:
    """The bits of time stamps of JAUS; `NO_STAMP` for what has none."""
    instants = [*zip(map(int, seconds.tolist()), map(int, nanoseconds.tolist()), strict=True)]
    known = {each: float(stamps.bits_of(*each)) for each in set(instants)}
    return _column([*map(known.__getitem__, instants)])
