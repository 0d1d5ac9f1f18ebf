"""Conversions of numbers, times, the cells of grids, and the pixels of images and picture files.

PGM has grey pixels and PPM coloured ones; PNM is what both are called (Netpbm). Numbers of 16 bits
begin with the more significant octet.
"""

from __future__ import annotations

import math
import re
import time
from datetime import date
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

from .types import ConversionError, Pixels, Time, TimeStamp

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping, Sequence

    from .types import TimeLike, TimeStampLike


__all__ = [
    "clamp",
    "cost_to_occupancy",
    "covariance_to_rms",
    "deadband",
    "degrees_to_radians",
    "limit",
    "linear",
    "look_up",
    "negate",
    "occupancy_to_cost",
    "percent_to_value",
    "pixels_to_pnm",
    "pnm_to_pixels",
    "radians_to_degrees",
    "reverse_rows",
    "scale",
    "square",
    "square_root",
    "time_to_timestamp",
    "timestamp_to_time",
    "value_to_percent",
]

_DEGREE = math.pi / 180.0
_RADIAN = 180.0 / math.pi

Key = TypeVar("Key", bound="Hashable")
Value = TypeVar("Value")


def negate(value: float) -> float:
    """The value with the opposite sign."""
    return -value


def scale(value: float, factor: float) -> float:
    """The value times `factor`."""
    return value * factor


def linear(value: float, factor: float, offset: float) -> float:
    """The value times `factor` plus `offset`."""
    return value * factor + offset


def clamp(value: float, minimum: float, maximum: float) -> float:
    """The value limited to minimum .. maximum; not a number stays so."""
    if value < minimum:
        return minimum
    if value > maximum:
        return maximum
    return value


def limit(value: float, maximum: float) -> float:
    """The value limited to -`maximum` .. `maximum`; not a number stays so."""
    return clamp(value, -maximum, maximum)


def deadband(value: float, width: float) -> float:
    """Zero when the magnitude is below `width`, else the value."""
    return 0.0 if abs(value) < width else value


def square(value: float) -> float:
    """The value squared."""
    return value * value


def degrees_to_radians(value: float) -> float:
    """Degrees to radians."""
    return value * _DEGREE


def radians_to_degrees(value: float) -> float:
    """Radians to degrees."""
    return value * _RADIAN


def square_root(value: float) -> float:
    """The square root: variance to root mean square; not a number where the value is negative."""
    return math.sqrt(value) if value >= 0.0 else math.nan


def covariance_to_rms(x: float, y: float, z: float) -> float:
    """The variances along three axes to one root mean square for each of the axes.

    Three zeros are not a number, and neither are variances of which one is negative: ROS marks
    unknown ones so (sensor_msgs/Imu).
    """
    if x == y == z == 0.0 or not (x >= 0.0 and y >= 0.0 and z >= 0.0):
        return math.nan
    return math.sqrt((x + y + z) / 3)


def value_to_percent(value: float, maximum: float) -> float:
    """The value in percent of `maximum`.

    Raises:
        ConversionError: The maximum is zero.
    """
    if maximum == 0.0:
        raise ConversionError("nothing is a percentage of zero")
    return value / maximum * 100.0


def percent_to_value(value: float, maximum: float) -> float:
    """Percent of `maximum` to the value."""
    return value / 100.0 * maximum


def look_up(value: Key, table: Mapping[Key, Value]) -> Value:
    """The counterpart of a value in a table.

    Raises:
        ConversionError: The table lacks the value.
    """
    try:
        return table[value]
    except KeyError:
        raise ConversionError(f"{value!r} is not in the table") from None


_DAY = 86_400
_DAY_NS = _DAY * 10**9
_EPOCH = date(1970, 1, 1).toordinal()


def timestamp_to_time(stamp: TimeStampLike, *, near: TimeLike) -> Time:
    """A JAUS TimeStamp (day of month, UTC) to the instant nearest to `near`.

    The TimeStamp names neither month nor year. Only a clock tells them, and only nearness makes a
    stamp from just before midnight of the last of the month right when it arrives on the first.

    Raises:
        ConversionError: hour, minutes, seconds or milliseconds are no time of day.
    """
    return instant_near(
        stamp.day, stamp.hour, stamp.minutes, stamp.seconds, stamp.milliseconds, near
    )


def time_to_timestamp(instant: TimeLike) -> TimeStamp:
    """An instant to a JAUS TimeStamp (day of month, UTC); parts of a millisecond are cut off."""
    utc = time.gmtime(instant.sec)
    milliseconds = instant.nanosec // 1_000_000
    return TimeStamp(milliseconds, utc.tm_sec, utc.tm_min, utc.tm_hour, utc.tm_mday)


def instant_near(
    day: int, hour: int, minutes: int, seconds: int, milliseconds: int, near: TimeLike
) -> Time:
    """The instant nearest to `near` that has a day of the month and a time of day, UTC.

    Raises:
        ConversionError: hour, minutes, seconds or milliseconds are no time of day.
    """
    if not (
        0 <= hour < 24 and 0 <= minutes < 60 and 0 <= seconds < 60 and 0 <= milliseconds < 1000
    ):
        raise ConversionError("TimeStamp is no time of day")
    of_day = (((hour * 60 + minutes) * 60 + seconds) * 1000 + milliseconds) * 10**6
    reference = near.sec * 10**9 + near.nanosec
    first, *others = _days_near(day, near.sec // _DAY)
    nearest = first * _DAY_NS + of_day
    for other in others:
        instant = other * _DAY_NS + of_day
        if abs(instant - reference) < abs(nearest - reference):
            nearest = instant
    return Time(*divmod(nearest, 10**9))


@lru_cache(maxsize=64)
def day_of_month(days: int) -> int:
    """The day of the month, UTC, of a number of days since 1970."""
    return time.gmtime(days * _DAY).tm_mday


@lru_cache(maxsize=64)
def _days_near(day_of_month: int, today: int) -> tuple[int, ...]:
    """Days since 1970 around one of them that are the given day of their month."""
    if not 1 <= day_of_month <= 31:
        # JAUS-DEVIATION: AS6009 has days 1..31, but known peers leave the day at 0. The nearest
        # day serves them better than the loss of every report.
        return today - 1, today, today + 1
    utc = time.gmtime(today * _DAY)
    days = []
    # On 1 March, 31 January is nearer than 31 March, and February has no such day.
    for offset in (-2, -1, 0, 1):
        year, month = divmod(utc.tm_year * 12 + utc.tm_mon - 1 + offset, 12)
        try:
            days.append(date(year, month + 1, day_of_month).toordinal() - _EPOCH)
        except ValueError:  # this month is shorter
            continue
    return tuple(days)


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


_SIZES = {"mono8": 1, "mono16": 2, "rgb8": 3, "bgr8": 3}
"""The octets of a pixel by encoding."""
_ENCODINGS = {(b"5", 255): "mono8", (b"5", 65535): "mono16", (b"6", 255): "rgb8"}
_BETWEEN = rb"(?:\s|#[^\r\n]*[\r\n])"
_HEADER = re.compile(
    rb"P([56])%b*([0-9]{1,9})%b+([0-9]{1,9})%b+([0-9]{1,9})(?:#[^\r\n]*)?\s"
    % (_BETWEEN, _BETWEEN, _BETWEEN)
)


def pixels_to_pnm(
    height: float,
    width: float,
    encoding: str,
    is_bigendian: float,
    step: float,
    data: Sequence[int],
) -> bytes:
    """The pixels as a file of PGM or PPM.

    Raises:
        ConversionError: The image is empty, has another encoding or other data than its rows.
    """
    size = _SIZES.get(encoding, 0)
    row, pitch, pixels = int(width) * size, int(step), bytes(data)
    if not size:
        raise ConversionError(f"{encoding!a} has no file of pictures")
    if not (height and row) or pitch < row or len(pixels) != height * pitch:
        raise ConversionError(f"{len(pixels)} octets are not {height} rows of {width} pixels")
    if pitch != row:
        pixels = b"".join(pixels[at : at + row] for at in range(0, len(pixels), pitch))
    if encoding == "bgr8" or (encoding == "mono16" and not is_bigendian):
        pixels = _turned(pixels, size)
    kind, greatest = 6 if size == 3 else 5, 65535 if encoding == "mono16" else 255
    return b"P%d %d %d %d\n%b" % (kind, width, height, greatest, pixels)


def pnm_to_pixels(file: Sequence[int]) -> Pixels:
    """The pixels of a file of PGM or PPM.

    Raises:
        ConversionError: It is no such file of 8 bits, or of 16 where it is grey, or is not whole.
    """
    octets = bytes(file)
    match = _HEADER.match(octets)
    if match is None:
        raise ConversionError("no file of PGM or PPM")
    width, height, greatest = map(int, match.groups()[1:])
    encoding = _ENCODINGS.get((match[1], greatest))
    if encoding is None:
        raise ConversionError(f"no encoding of P{match[1].decode()} has numbers up to {greatest}")
    pixels, step = octets[match.end() :], width * _SIZES[encoding]
    if not pixels or len(pixels) != height * step:
        raise ConversionError(f"{len(pixels)} octets are not {height} rows of {width} pixels")
    if encoding == "mono16":
        pixels = _turned(pixels, 2)
    return Pixels(height, width, encoding, 0, step, pixels)


def _turned(pixels: bytes, size: int) -> bytes:
    """The octets of each pixel in the opposite order."""
    turned = bytearray(len(pixels))
    for part in range(size):
        turned[part::size] = pixels[size - 1 - part :: size]
    return bytes(turned)
