"""Conversions of columns: of the values of all elements of a list at once, in arrays of numpy.

What comes out is what the conversion of the same name makes of each value, to the last bit: numpy
does the arithmetic, which IEEE 754 fixes, and the functions of `math` do the others. What the
conversion refuses is refused here by `UnevenError`: who asked goes through the elements one by one
then. Each takes single values as well, which are the same in all elements, and of single values
alone each is the conversion itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, TypeGuard

import numpy

from . import numbers, orientations
from .types import Angles, Quaternion, Time, UnevenError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from .types import QuaternionLike, TimeLike, TimeStampLike

    Values = NDArray[Any] | Any
    """A column, or what is the same in all elements."""

_TYPES = {code: numpy.dtype(f"<{code}") for code in "bBhHiIqQfd"}

_LARGEST_SINGLE = 3.4028234663852886e38

# Closer to vertical than this, roll and yaw turn about the same axis.
_VERTICAL = 1.0 - 1e-12


def is_column(value: object) -> TypeGuard[NDArray[Any]]:
    """Whether a value is a column."""
    return isinstance(value, numpy.ndarray)


def fit(values: NDArray[Any], least: float, greatest: float) -> bool:
    """Whether all values of a column are within a range; what is no number is not."""
    low: float = values[values.argmin()]
    high: float = values[values.argmax()]
    return bool(least <= low and high <= greatest)


def odd(values: NDArray[Any], least: float, greatest: float) -> list[int]:
    """Returns the indexes of the values that are not within a range."""
    found: list[int] = numpy.flatnonzero(~((values >= least) & (values <= greatest))).tolist()
    return found


def not_numbers(values: NDArray[Any]) -> bool:
    """Whether none of the values is a number."""
    return values.dtype.kind == "f" and bool(numpy.isnan(values).all())


def rounded(values: Any) -> Any:
    """Returns the nearest integers, the even one of two."""
    if values.dtype.kind != "f":
        return values
    if not numpy.isfinite(values).all():
        raise UnevenError
    return numpy.rint(values).astype("i8")


def listed_in(values: Any, ranges: Sequence[tuple[int, int]]) -> Any:
    """Returns the nearest integers, each of which is within one of several ranges."""
    whole = rounded(values)
    found = [(whole >= low) & (whole <= high) for low, high in ranges]
    if not numpy.logical_or.reduce(found).all():
        raise UnevenError
    return whole


def as_column(values: NDArray[Any]) -> NDArray[Any]:
    """Returns numbers as those that conversions take: real ones of 64 bits, or such integers."""
    if values.dtype.kind == "f":
        return values.astype("f8")
    if values.dtype.kind == "u" and values.itemsize == 8:
        raise UnevenError
    return values.astype("i8")


def in_range(values: NDArray[Any], code: str) -> NDArray[Any]:
    """Returns numbers in the type of a format character of `struct`, little-endian."""
    kind = _TYPES[code]
    if kind.kind in "iu":
        info = numpy.iinfo(kind)
        if values.dtype.kind != "i" or not fit(values, info.min, info.max):
            raise UnevenError
    found = values.astype(kind, copy=False)
    if code == "f" and not fit(found, -_LARGEST_SINGLE, _LARGEST_SINGLE):
        finite = numpy.isfinite(found)
        if (finite != numpy.isfinite(values)).any():
            raise UnevenError  # it was too large
    return found


# ------------------------------------------------------------------ expressions


def real(value: Any) -> Any:
    """Numbers or truths as real numbers."""
    return value.astype("f8") if is_column(value) else float(value)


def choose(condition: Any, value: Any, otherwise: Any) -> Any:
    """One value where a condition holds, and another one where it does not."""
    if is_column(condition):
        return numpy.where(condition, value, otherwise)
    return value if condition else otherwise


def negation(condition: Any) -> Any:
    """Where a condition does not hold."""
    return ~condition if is_column(condition) else not condition


# ------------------------------------------------------------------ numbers


def look_up(value: Any, table: Any) -> Any:
    """The counterparts of values in a table."""
    if not is_column(value):
        return numbers.look_up(value, table)
    found = value.tolist()
    try:
        known = {each: table[each] for each in set(found)}
    except KeyError:
        raise UnevenError from None
    return numpy.array([known[each] for each in found])


# ------------------------------------------------------------------ angles


def wrap_angle(value: Any) -> Any:
    """The same directions in [-pi, pi]."""
    if not is_column(value):
        return orientations.wrap_angle(value)
    if fit(value, -math.pi, math.pi):
        return value
    return numpy.array([*map(orientations.wrap_angle, value.tolist())])


def ned_heading_to_enu_yaw(value: Any) -> Any:
    """Headings clockwise from north to yaws counter-clockwise from east, in [-pi, pi]."""
    return wrap_angle(math.pi / 2 - value)


def enu_yaw_to_ned_heading(value: Any) -> Any:
    """Yaws counter-clockwise from east to headings clockwise from north, in [-pi, pi]."""
    return wrap_angle(math.pi / 2 - value)


def frd_angles_to_flu_quaternion(roll: Any, pitch: Any, yaw: Any) -> Quaternion:
    """The rotations about x by roll, then about y by -pitch, then about z by -yaw."""
    if not any(map(is_column, (roll, pitch, yaw))):
        return orientations.frd_angles_to_flu_quaternion(roll, pitch, yaw)
    return _from_angles(roll, -pitch, -yaw)


def ned_angles_to_enu_quaternion(roll: Any, pitch: Any, heading: Any) -> Quaternion:
    """The same as of yaw, which is a quarter turn less the heading."""
    if not any(map(is_column, (roll, pitch, heading))):
        return orientations.ned_angles_to_enu_quaternion(roll, pitch, heading)
    return _from_angles(roll, -pitch, math.pi / 2 - heading)


def flu_quaternion_to_frd_angles(orientation: QuaternionLike) -> Angles:
    """Rolls, pitches and yaws about forward-right-down axes.

    If one quaternion points up or down, is of length zero or has what is no number, they are
    computed one by one.
    """
    x, y, z, w = parts = orientation.x, orientation.y, orientation.z, orientation.w
    if not any(map(is_column, parts)):
        return orientations.flu_quaternion_to_frd_angles(orientation)
    y, z = -y, -z
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    sines = numpy.asarray(2 * (w * y - z * x) / (xx + yy + zz + ww))
    if not fit(sines, -_VERTICAL, _VERTICAL):
        return _angles_one_by_one(*parts)
    return Angles(
        _directions(2 * (w * x + y * z), ww - xx - yy + zz),
        numpy.fromiter(map(math.asin, sines.tolist()), "f8", len(sines)),  # type: ignore[arg-type]
        _directions(2 * (w * z + x * y), ww + xx - yy - zz),
    )


def enu_quaternion_to_ned_angles(orientation: QuaternionLike) -> Angles:
    """Rolls, pitches and headings in north-east-down of orientations in east-north-up."""
    roll, pitch, yaw = flu_quaternion_to_frd_angles(orientation)
    return Angles(roll, pitch, wrap_angle(math.pi / 2 + yaw))


def _angles_one_by_one(*parts: Any) -> Angles:
    found = [orientations.flu_quaternion_to_frd_angles(Quaternion(*row)) for row in _rows(*parts)]
    return Angles(*numpy.array(found).T)


def _directions(y: Any, x: Any) -> Any:
    return numpy.fromiter(map(math.atan2, y.tolist(), x.tolist()), "f8", len(y))


def _from_angles(roll: Any, pitch: Any, yaw: Any) -> Quaternion:
    """The rotations about x by roll, then about y by pitch, then about z by yaw."""
    try:
        (sr, cr), (sp, cp), (sy, cy) = map(_sines_and_cosines, (roll, pitch, yaw))
    except ValueError:  # of an infinite angle
        raise UnevenError from None
    level, upright, sides, both = sr * cp, cr * cp, cr * sp, sr * sp
    return Quaternion(
        level * cy - sides * sy,
        sides * cy + level * sy,
        upright * sy - both * cy,
        upright * cy + both * sy,
    )


def _sines_and_cosines(angles: Any) -> tuple[Any, Any]:
    """Returns sines and cosines of half of the angles; one of each where all are the same."""
    if not is_column(angles):
        return math.sin(angles / 2), math.cos(angles / 2)
    halves: list[float] = (angles / 2).tolist()
    first, count = halves[0], len(halves)
    # Zeros with different signs are not the same.
    if first and halves.count(first) == count:
        return math.sin(first), math.cos(first)
    sines = numpy.fromiter(map(math.sin, halves), "f8", count)
    return sines, numpy.fromiter(map(math.cos, halves), "f8", count)


# ------------------------------------------------------------------ time stamps


class _Parts(NamedTuple):
    """Parts of time stamps, each a column or the same in all."""

    milliseconds: Any
    seconds: Any
    minutes: Any
    hour: Any
    day: Any


def timestamp_to_time(stamp: TimeStampLike, *, near: TimeLike) -> Any:
    """Time stamps of JAUS to the instants nearest to `near`."""
    parts = stamp.milliseconds, stamp.seconds, stamp.minutes, stamp.hour, stamp.day
    if not any(map(is_column, parts)):
        return numbers.timestamp_to_time(stamp, near=near)
    rows = _rows(*parts)
    return Time(*_each(rows, lambda row: numbers.timestamp_to_time(_Parts(*row), near=near)))


def time_to_timestamp(instant: TimeLike) -> Any:
    """Instants to time stamps of JAUS."""
    if not (is_column(instant.sec) or is_column(instant.nanosec)):
        return numbers.time_to_timestamp(instant)
    rows = _rows(instant.sec, instant.nanosec)
    return _Parts(*_each(rows, lambda row: numbers.time_to_timestamp(Time(*row))))


def _rows(*parts: Any) -> list[tuple[Any, ...]]:
    """Parts of each element, of columns and what is the same in all."""
    return [*zip(*(each.tolist() for each in numpy.broadcast_arrays(*parts)), strict=True)]


def _each(rows: list[tuple[Any, ...]], convert: Callable[[Any], tuple[int, ...]]) -> NDArray[Any]:
    """The results for rows, one column for each; what is the same is computed once."""
    known = {row: convert(row) for row in set(rows)}
    found: NDArray[Any] = numpy.array([known[row] for row in rows]).T
    return found
