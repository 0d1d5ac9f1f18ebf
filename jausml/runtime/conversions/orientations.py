"""Conversions of angles and orientations.

Axes: JAUS has x forward or north, y right or east, z down, and angles that turn right-handed about
them (AS6009, CommandClass). ROS has x forward, y left, z up on a body and x east, y north, z up on
the earth (REP 103). Angles are radians. An infinite angle gives NaN, to which the out-of-range
policy of the target applies, and so does a quaternion of length zero, which is no orientation.
"""

from __future__ import annotations

import math

from .types import Angles, Quaternion, QuaternionLike

# Closer to vertical than this, roll and yaw turn about the same axis.
_VERTICAL = 1.0 - 1e-12


def wrap_angle(value: float) -> float:
    """The same direction in [-pi, pi]; NaN for an infinite angle."""
    return math.nan if math.isinf(value) else math.remainder(value, math.tau)


def ned_heading_to_enu_yaw(value: float) -> float:
    """Heading clockwise from north to yaw counter-clockwise from east, in [-pi, pi]."""
    return wrap_angle(math.pi / 2 - value)


def enu_yaw_to_ned_heading(value: float) -> float:
    """Yaw counter-clockwise from east to heading clockwise from north, in [-pi, pi]."""
    return wrap_angle(math.pi / 2 - value)


def frd_angles_to_flu_quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Roll, pitch and yaw about forward-right-down axes to the orientation in forward-left-up."""
    return _from_angles(roll, -pitch, -yaw)


def frd_yaw_to_flu_quaternion(yaw: float) -> Quaternion:
    """Yaw about the down axis to the orientation in forward-left-up."""
    try:
        return Quaternion(0.0, 0.0, math.sin(-yaw / 2), math.cos(yaw / 2))
    except ValueError:  # of an infinite angle
        return Quaternion(0.0, 0.0, math.nan, math.nan)


def flu_quaternion_to_frd_roll(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to roll about forward-right-down axes, in [-pi, pi]."""
    return flu_quaternion_to_frd_angles(orientation).roll


def flu_quaternion_to_frd_pitch(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to pitch about forward-right-down axes, in [-pi/2, pi/2]."""
    return flu_quaternion_to_frd_angles(orientation).pitch


def flu_quaternion_to_frd_yaw(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to yaw about forward-right-down axes, in [-pi, pi]."""
    return flu_quaternion_to_frd_angles(orientation).yaw


def flu_quaternion_to_frd_angles(orientation: QuaternionLike) -> Angles:
    """Orientation in forward-left-up to roll, pitch and yaw about forward-right-down axes."""
    x, y, z, w = orientation.x, -orientation.y, -orientation.z, orientation.w
    squared_length = x * x + y * y + z * z + w * w
    if squared_length == 0.0:
        return Angles(math.nan, math.nan, math.nan)
    sine = 2 * (w * y - z * x) / squared_length
    if math.isnan(sine):
        return Angles(math.nan, sine, math.nan)
    if -_VERTICAL <= sine <= _VERTICAL:
        return Angles(
            math.atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z),
            math.asin(sine),
            math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z),
        )
    # Near the vertical, roll is taken as zero, and yaw gives the whole turn.
    yaw = math.atan2(-2 * (x * y - w * z), w * w - x * x + y * y - z * z)
    return Angles(0.0, math.asin(max(-1.0, min(1.0, sine))), yaw)


def ned_angles_to_enu_quaternion(roll: float, pitch: float, heading: float) -> Quaternion:
    """Roll, pitch and heading in north-east-down to the orientation in east-north-up.

    The angles are those of a forward-right-down body in north-east-down, the orientation that of
    the same body, as forward-left-up, in east-north-up.
    """
    return _from_angles(roll, -pitch, math.pi / 2 - heading)


def ned_heading_to_enu_quaternion(heading: float) -> Quaternion:
    """Heading clockwise from north to the orientation of a level body in east-north-up."""
    half_yaw = (math.pi / 2 - heading) / 2
    try:
        return Quaternion(0.0, 0.0, math.sin(half_yaw), math.cos(half_yaw))
    except ValueError:  # of an infinite angle
        return Quaternion(0.0, 0.0, math.nan, math.nan)


def enu_quaternion_to_ned_angles(orientation: QuaternionLike) -> Angles:
    """Orientation in east-north-up to roll, pitch and heading in north-east-down.

    The orientation is that of a forward-left-up body, the angles those of the same body, as
    forward-right-down.
    """
    roll, pitch, yaw = flu_quaternion_to_frd_angles(orientation)
    # A yaw of zero points east, a heading of a quarter turn.
    return Angles(roll, pitch, math.remainder(math.pi / 2 + yaw, math.tau))


def enu_quaternion_to_ned_heading(orientation: QuaternionLike) -> float:
    """Orientation of a body in east-north-up to its heading clockwise from north, in [-pi, pi]."""
    return enu_quaternion_to_ned_angles(orientation).yaw


def _from_angles(roll: float, pitch: float, yaw: float) -> Quaternion:
    """The rotation about x by roll, then about y by pitch, then about z by yaw."""
    try:
        sr, cr = math.sin(roll / 2), math.cos(roll / 2)
        sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
        sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
    except ValueError:  # of an infinite angle
        return Quaternion(math.nan, math.nan, math.nan, math.nan)
    return Quaternion(
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
