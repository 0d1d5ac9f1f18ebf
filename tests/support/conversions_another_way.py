"""Conversions computed another way than the runtime and the definitions do, for tests.

Orientations are products of turns about single axes, and their angles where they turn the axes of
a body; times are those of the calendar of the standard library.
"""

import math
from datetime import datetime, timedelta, timezone

# Closer to vertical than this, roll and yaw turn about the same axis, and roll is taken as zero.
_VERTICAL = 1.0 - 1e-12
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
# The next day of the same number is at most this far, as from 31 July to 31 May.
_FARTHEST = 62
_DAY = timedelta(days=1)


def orientation(roll, pitch, yaw):
    """Returns x, y, z and w of the orientation that turns by some angles."""
    return _times(_turn(2, yaw), _times(_turn(1, pitch), _turn(0, roll)))


def angles(parts):
    """Returns roll, pitch and yaw of an orientation; not numbers for one of length zero."""
    length = math.hypot(*parts)
    if length == 0.0:
        return math.nan, math.nan, math.nan
    x, y, z, w = (part / length for part in parts)
    forward, left, up = (_turned((x, y, z, w), axis) for axis in range(3))
    pitch = math.atan2(-forward[2], math.hypot(forward[0], forward[1]))
    if abs(forward[2]) > _VERTICAL:
        return 0.0, pitch, math.atan2(-left[0], left[1])
    return math.atan2(left[2], up[2]), pitch, math.atan2(forward[1], forward[0])


def _turn(axis, angle):
    parts = [0.0, 0.0, 0.0, math.cos(angle / 2)]
    parts[axis] = math.sin(angle / 2)
    return parts[0], parts[1], parts[2], parts[3]


def _turned(parts, axis):
    """Where an orientation of length one turns the vector of an axis."""
    x, y, z, w = parts
    vector = [0.0, 0.0, 0.0, 0.0]
    vector[axis] = 1.0
    turned = _times(_times(parts, (vector[0], vector[1], vector[2], 0.0)), (-x, -y, -z, w))
    return turned[:3]


def _times(a, b):
    """Hamilton product: first the turn `b`, then `a`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _heading(yaw):
    """The heading of a yaw, in [-pi, pi]."""
    return math.atan2(math.cos(yaw), math.sin(yaw))


def _frd_angles(parts):
    roll, pitch, yaw = angles(parts)
    return roll, -pitch, -yaw


def _ned_angles(parts):
    roll, pitch, yaw = angles(parts)
    return roll, -pitch, _heading(yaw)


def timestamp_to_time(stamp, near):
    """The nearest of all instants around with this day and time; any day for day 0, or None."""
    milliseconds, seconds, minutes, hour, day = stamp
    now = _EPOCH + timedelta(seconds=near[0])
    try:
        found = now.replace(
            hour=hour, minute=minutes, second=seconds, microsecond=milliseconds * 1000
        )
    except ValueError:
        return None
    days = range(-_FARTHEST, _FARTHEST + 1)
    instants = [_instant(found + n * _DAY) for n in days if _is_day(found, n, day)]
    return min(instants, key=lambda instant: abs(_nanoseconds(instant) - _nanoseconds(near)))


def time_to_timestamp(instant):
    """Day and time of the calendar."""
    found = _EPOCH + timedelta(seconds=instant[0])
    return instant[1] // 10**6, found.second, found.minute, found.hour, found.day


def _is_day(first, number, day):
    return not 1 <= day <= 31 or (first + number * _DAY).day == day


def _instant(moment):
    since = moment - _EPOCH
    return since // timedelta(seconds=1), since.microseconds * 1000


def _nanoseconds(instant):
    return instant[0] * 10**9 + instant[1]


ORIENTATIONS = {
    "frd_angles_to_flu_quaternion": lambda roll, pitch, yaw: orientation(roll, -pitch, -yaw),
    "frd_yaw_to_flu_quaternion": lambda yaw: orientation(0.0, 0.0, -yaw),
    "flu_quaternion_to_frd_roll": lambda parts: angles(parts)[0],
    "flu_quaternion_to_frd_pitch": lambda parts: -angles(parts)[1],
    "flu_quaternion_to_frd_yaw": lambda parts: -angles(parts)[2],
    "flu_quaternion_to_frd_angles": _frd_angles,
    "ned_angles_to_enu_quaternion": lambda roll, pitch, heading: orientation(
        roll, -pitch, math.pi / 2 - heading
    ),
    "ned_heading_to_enu_quaternion": lambda heading: orientation(0.0, 0.0, math.pi / 2 - heading),
    "enu_quaternion_to_ned_heading": lambda parts: _heading(angles(parts)[2]),
    "enu_quaternion_to_ned_angles": _ned_angles,
}
