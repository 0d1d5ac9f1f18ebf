"""Value conversions of attribute maps, as pure functions.

Each literal of `ConversionKind` in bridge.ecore has the function of the same name here. Its
positional parameters are the inputs and then the arguments that the literal is annotated with.

Axes: JAUS has x forward or north, y right or east, z down, and angles that turn right-handed about
them (AS6009, CommandClass). ROS has x forward, y left, z up on a body and x east, y north, z up on
the earth (REP 103). Angles are radians unless a name says degrees.

Messages of either side are read by attribute, so that this module needs neither; results are named
tuples with the same attributes.
"""

from __future__ import annotations

import math
import time
from datetime import date
from typing import NamedTuple, Protocol

_DAY_NS = 86_400 * 10**9
_EPOCH = date(1970, 1, 1).toordinal()
# Closer to vertical than this, roll and yaw turn about the same axis.
_VERTICAL = 1.0 - 1e-12


class ConversionError(ValueError):
    """A value that has no counterpart on the other side."""


class QuaternionLike(Protocol):
    """What geometry_msgs/Quaternion offers."""

    @property
    def x(self) -> float:
        """First part of the vector."""

    @property
    def y(self) -> float:
        """Second part of the vector."""

    @property
    def z(self) -> float:
        """Third part of the vector."""

    @property
    def w(self) -> float:
        """Scalar part."""


class TimeLike(Protocol):
    """What builtin_interfaces/Time offers."""

    @property
    def sec(self) -> int:
        """Seconds since 1970-01-01 UTC."""

    @property
    def nanosec(self) -> int:
        """Nanoseconds within the second."""


class TimeStampLike(Protocol):
    """What the TimeStamp of a JAUS report offers (AS6009)."""

    @property
    def milliseconds(self) -> int:
        """0..999."""

    @property
    def seconds(self) -> int:
        """0..59."""

    @property
    def minutes(self) -> int:
        """0..59."""

    @property
    def hour(self) -> int:
        """0..23."""

    @property
    def day(self) -> int:
        """Day of the month, 1..31."""


class Quaternion(NamedTuple):
    """An orientation, with the attributes of geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


class Time(NamedTuple):
    """An instant since 1970-01-01 UTC, with the attributes of builtin_interfaces/Time."""

    sec: int
    nanosec: int


class TimeStamp(NamedTuple):
    """A time of a day of an unnamed month, UTC, with the attributes of a JAUS TimeStamp."""

    milliseconds: int
    seconds: int
    minutes: int
    hour: int
    day: int


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


def deadband(value: float, width: float) -> float:
    """Zero when the magnitude is below `width`, else the value."""
    return 0.0 if abs(value) < width else value


def square(value: float) -> float:
    """The value squared."""
    return value * value


def degrees_to_radians(value: float) -> float:
    """Degrees to radians."""
    return math.radians(value)


def radians_to_degrees(value: float) -> float:
    """Radians to degrees."""
    return math.degrees(value)


def ned_heading_to_enu_yaw(value: float) -> float:
    """Heading clockwise from north to yaw counter-clockwise from east, in [-pi, pi]."""
    return _wrap(math.pi / 2 - value)


def enu_yaw_to_ned_heading(value: float) -> float:
    """Yaw counter-clockwise from east to heading clockwise from north, in [-pi, pi]."""
    return _wrap(math.pi / 2 - value)


def frd_angles_to_flu_quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Roll, pitch and yaw about forward-right-down axes to the orientation in forward-left-up."""
    return _from_angles(roll, -pitch, -yaw)


def frd_yaw_to_flu_quaternion(yaw: float) -> Quaternion:
    """Yaw about the down axis alone to the orientation in forward-left-up."""
    return Quaternion(0.0, 0.0, math.sin(-yaw / 2), math.cos(yaw / 2))


def flu_quaternion_to_frd_roll(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to roll about forward-right-down axes, in [-pi, pi].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    x, y, z, w = orientation.x, -orientation.y, -orientation.z, orientation.w
    sine = _sine_of_pitch(x, y, z, w)
    if math.isnan(sine):
        return math.nan
    if abs(sine) > _VERTICAL:
        return 0.0
    return math.atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z)


def flu_quaternion_to_frd_pitch(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to pitch about forward-right-down axes, in [-pi/2, pi/2].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    sine = _sine_of_pitch(orientation.x, -orientation.y, -orientation.z, orientation.w)
    return math.asin(clamp(sine, -1.0, 1.0))


def flu_quaternion_to_frd_yaw(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to yaw about forward-right-down axes, in [-pi, pi].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    x, y, z, w = orientation.x, -orientation.y, -orientation.z, orientation.w
    sine = _sine_of_pitch(x, y, z, w)
    if math.isnan(sine):
        return math.nan
    if abs(sine) > _VERTICAL:
        # Roll is taken as zero there, so that the three angles still give the orientation.
        return math.atan2(-2 * (x * y - w * z), w * w - x * x + y * y - z * z)
    return math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def ned_angles_to_enu_quaternion(roll: float, pitch: float, heading: float) -> Quaternion:
    """Roll, pitch and heading in north-east-down to the orientation in east-north-up.

    The angles are those of a forward-right-down body in north-east-down, the orientation that of
    the same body, as forward-left-up, in east-north-up.
    """
    return _from_angles(roll, -pitch, math.pi / 2 - heading)


def timestamp_to_time(stamp: TimeStampLike, *, near: TimeLike) -> Time:
    """A JAUS TimeStamp (day of month, UTC) to the instant nearest to `near`.

    The TimeStamp names neither month nor year. Only a clock tells them, and only nearness makes a
    stamp from just before midnight of the last of the month right when it arrives on the first.

    Raises:
        ConversionError: hour, minutes, seconds or milliseconds are no time of day.
    """
    if not (
        0 <= stamp.hour < 24
        and 0 <= stamp.minutes < 60
        and 0 <= stamp.seconds < 60
        and 0 <= stamp.milliseconds < 1000
    ):
        raise ConversionError("TimeStamp is no time of day")
    minutes = stamp.hour * 60 + stamp.minutes
    of_day = ((minutes * 60 + stamp.seconds) * 1000 + stamp.milliseconds) * 10**6
    reference = near.sec * 10**9 + near.nanosec
    instants = [day * _DAY_NS + of_day for day in _days_near(stamp.day, near.sec)]
    return Time(*divmod(min(instants, key=lambda instant: abs(instant - reference)), 10**9))


def time_to_timestamp(instant: TimeLike) -> TimeStamp:
    """An instant to a JAUS TimeStamp (day of month, UTC); parts of a millisecond are cut off."""
    utc = time.gmtime(instant.sec)
    milliseconds = instant.nanosec // 1_000_000
    return TimeStamp(milliseconds, utc.tm_sec, utc.tm_min, utc.tm_hour, utc.tm_mday)


def _wrap(angle: float) -> float:
    # An infinite angle has no direction: the limit of the target field judges what becomes of it.
    return math.nan if math.isinf(angle) else math.remainder(angle, math.tau)


def _from_angles(roll: float, pitch: float, yaw: float) -> Quaternion:
    """The rotation about x by roll, then about y by pitch, then about z by yaw."""
    sr, cr = math.sin(roll / 2), math.cos(roll / 2)
    sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
    sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
    return Quaternion(
        x=sr * cp * cy - cr * sp * sy,
        y=cr * sp * cy + sr * cp * sy,
        z=cr * cp * sy - sr * sp * cy,
        w=cr * cp * cy + sr * sp * sy,
    )


def _sine_of_pitch(x: float, y: float, z: float, w: float) -> float:
    squared_length = x * x + y * y + z * z + w * w
    if squared_length == 0.0:
        return math.nan
    return 2 * (w * y - z * x) / squared_length


def _days_near(day_of_month: int, seconds: int) -> list[int]:
    """Days since 1970 around an instant that are the given day of their month."""
    utc = time.gmtime(seconds)
    if not 1 <= day_of_month <= 31:
        # JAUS-DEVIATION: AS6009 has days 1..31, but known peers leave the day at 0. The nearest
        # day serves them better than the loss of every report.
        today = date(utc.tm_year, utc.tm_mon, utc.tm_mday).toordinal() - _EPOCH
        return [today - 1, today, today + 1]
    days = []
    for offset in (-1, 0, 1):
        year, month = divmod(utc.tm_year * 12 + utc.tm_mon - 1 + offset, 12)
        try:
            days.append(date(year, month + 1, day_of_month).toordinal() - _EPOCH)
        except ValueError:  # this month is shorter
            continue
    return days
