"""Orientations part by part: the arithmetic of the conversions in `orientations`, without objects.

Each function has the name of the conversion whose arithmetic it is. It takes the parts of a
quaternion as x, y, z and w, and yields them so. Translations from bytes to bytes call these.
"""

from __future__ import annotations

import math

Parts = tuple[float, float, float, float]
"""Parts of a quaternion: x, y, z and w."""

# Closer to vertical than this, roll and yaw turn about the same axis.
_VERTICAL = 1.0 - 1e-12


def frd_angles_to_flu_quaternion(roll: float, pitch: float, yaw: float) -> Parts:
    """The rotation about x by roll, then about y by -pitch, then about z by -yaw."""
    return _from_angles(roll, -pitch, -yaw)


def frd_yaw_to_flu_quaternion(yaw: float) -> Parts:
    """The rotation about z by -yaw."""
    return 0.0, 0.0, math.sin(-yaw / 2), math.cos(yaw / 2)


def ned_angles_to_enu_quaternion(roll: float, pitch: float, heading: float) -> Parts:
    """The same as of yaw, which is a quarter turn less the heading."""
    return _from_angles(roll, -pitch, math.pi / 2 - heading)


def ned_heading_to_enu_quaternion(heading: float) -> Parts:
    """The rotation about z by a quarter turn less the heading."""
    half_yaw = (math.pi / 2 - heading) / 2
    return 0.0, 0.0, math.sin(half_yaw), math.cos(half_yaw)


def flu_quaternion_to_frd_roll(x: float, y: float, z: float, w: float) -> float:
    """Roll about forward-right-down axes; not a number of a quaternion of length zero."""
    return flu_quaternion_to_frd_angles(x, y, z, w)[0]


def flu_quaternion_to_frd_pitch(x: float, y: float, z: float, w: float) -> float:
    """Pitch about forward-right-down axes; not a number of a quaternion of length zero."""
    return flu_quaternion_to_frd_angles(x, y, z, w)[1]


def flu_quaternion_to_frd_yaw(x: float, y: float, z: float, w: float) -> float:
    """Yaw about forward-right-down axes; not a number of a quaternion of length zero."""
    return flu_quaternion_to_frd_angles(x, y, z, w)[2]


def flu_quaternion_to_frd_angles(
    x: float, y: float, z: float, w: float
) -> tuple[float, float, float]:
    """Roll, pitch and yaw about forward-right-down axes.

    A quaternion of length zero is no orientation: the results are not numbers.
    """
    y, z = -y, -z
    squared_length = x * x + y * y + z * z + w * w
    if squared_length == 0.0:
        return math.nan, math.nan, math.nan
    sine = 2 * (w * y - z * x) / squared_length
    if math.isnan(sine):
        return math.nan, sine, math.nan
    if -_VERTICAL <= sine <= _VERTICAL:
        return (
            math.atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z),
            math.asin(sine),
            math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z),
        )
    # Roll is taken as zero there, so that the three angles still give the orientation.
    yaw = math.atan2(-2 * (x * y - w * z), w * w - x * x + y * y - z * z)
    return 0.0, math.asin(max(-1.0, min(1.0, sine))), yaw


def enu_quaternion_to_ned_angles(
    x: float, y: float, z: float, w: float
) -> tuple[float, float, float]:
    """Roll, pitch and heading in north-east-down of an orientation in east-north-up."""
    roll, pitch, yaw = flu_quaternion_to_frd_angles(x, y, z, w)
    return roll, pitch, math.remainder(math.pi / 2 + yaw, math.tau)


def enu_quaternion_to_ned_heading(x: float, y: float, z: float, w: float) -> float:
    """Heading clockwise from north of an orientation in east-north-up."""
    # A yaw of zero points east there, which is a heading of a quarter turn.
    return math.remainder(math.pi / 2 + flu_quaternion_to_frd_angles(x, y, z, w)[2], math.tau)


def _from_angles(roll: float, pitch: float, yaw: float) -> Parts:
    """The rotation about x by roll, then about y by pitch, then about z by yaw."""
    sr, cr = math.sin(roll / 2), math.cos(roll / 2)
    sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
    sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
