"""Conversions of angles and orientations.

Axes: JAUS has x forward or north, y right or east, z down, and angles that turn right-handed about
them (AS6009, CommandClass). ROS has x forward, y left, z up on a body and x east, y north, z up on
the earth (REP 103). Angles are radians.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from . import rotations
from .types import Angles, Quaternion

if TYPE_CHECKING:
    from .types import QuaternionLike

__all__ = [
    "enu_quaternion_to_ned_angles",
    "enu_quaternion_to_ned_heading",
    "enu_yaw_to_ned_heading",
    "flu_quaternion_to_frd_angles",
    "flu_quaternion_to_frd_pitch",
    "flu_quaternion_to_frd_roll",
    "flu_quaternion_to_frd_yaw",
    "frd_angles_to_flu_quaternion",
    "frd_yaw_to_flu_quaternion",
    "ned_angles_to_enu_quaternion",
    "ned_heading_to_enu_quaternion",
    "ned_heading_to_enu_yaw",
    "orientation_if_known",
    "wrap_angle",
]


def wrap_angle(value: float) -> float:
    """The same direction in [-pi, pi]; an infinite angle has none, and is not a number then."""
    return math.nan if math.isinf(value) else math.remainder(value, math.tau)


def ned_heading_to_enu_yaw(value: float) -> float:
    """Heading clockwise from north to yaw counter-clockwise from east, in [-pi, pi]."""
    return wrap_angle(math.pi / 2 - value)


def enu_yaw_to_ned_heading(value: float) -> float:
    """Yaw counter-clockwise from east to heading clockwise from north, in [-pi, pi]."""
    return wrap_angle(math.pi / 2 - value)


def orientation_if_known(orientation: QuaternionLike, variance: float) -> Quaternion:
    """The orientation, or one of length zero where the variance beside it is negative.

    A first variance of -1 says in sensor_msgs/Imu that the orientation is unknown.
    """
    if variance < 0.0:
        return Quaternion(0.0, 0.0, 0.0, 0.0)
    return Quaternion(orientation.x, orientation.y, orientation.z, orientation.w)


def frd_angles_to_flu_quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Roll, pitch and yaw about forward-right-down axes to the orientation in forward-left-up."""
    return Quaternion(*rotations.frd_angles_to_flu_quaternion(roll, pitch, yaw))


def frd_yaw_to_flu_quaternion(yaw: float) -> Quaternion:
    """Yaw about the down axis alone to the orientation in forward-left-up."""
    return Quaternion(*rotations.frd_yaw_to_flu_quaternion(yaw))


def flu_quaternion_to_frd_roll(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to roll about forward-right-down axes, in [-pi, pi].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    return rotations.flu_quaternion_to_frd_roll(
        orientation.x, orientation.y, orientation.z, orientation.w
    )


def flu_quaternion_to_frd_pitch(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to pitch about forward-right-down axes, in [-pi/2, pi/2].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    return rotations.flu_quaternion_to_frd_pitch(
        orientation.x, orientation.y, orientation.z, orientation.w
    )


def flu_quaternion_to_frd_yaw(orientation: QuaternionLike) -> float:
    """Orientation in forward-left-up to yaw about forward-right-down axes, in [-pi, pi].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    return rotations.flu_quaternion_to_frd_yaw(
        orientation.x, orientation.y, orientation.z, orientation.w
    )


def flu_quaternion_to_frd_angles(orientation: QuaternionLike) -> Angles:
    """Orientation in forward-left-up to roll, pitch and yaw about forward-right-down axes.

    A quaternion of length zero is no orientation: the results are not numbers.
    """
    parts = rotations.flu_quaternion_to_frd_angles(
        orientation.x, orientation.y, orientation.z, orientation.w
    )
    return Angles(*parts)


def ned_angles_to_enu_quaternion(roll: float, pitch: float, heading: float) -> Quaternion:
    """Roll, pitch and heading in north-east-down to the orientation in east-north-up.

    The angles are those of a forward-right-down body in north-east-down, the orientation that of
    the same body, as forward-left-up, in east-north-up.
    """
    return Quaternion(*rotations.ned_angles_to_enu_quaternion(roll, pitch, heading))


def ned_heading_to_enu_quaternion(heading: float) -> Quaternion:
    """Heading clockwise from north alone to the orientation of a level body in east-north-up."""
    return Quaternion(*rotations.ned_heading_to_enu_quaternion(heading))


def enu_quaternion_to_ned_angles(orientation: QuaternionLike) -> Angles:
    """Orientation in east-north-up to roll, pitch and heading in north-east-down.

    The orientation is that of a forward-left-up body, the angles those of the same body, as
    forward-right-down. A quaternion of length zero gives what are no numbers.
    """
    parts = rotations.enu_quaternion_to_ned_angles(
        orientation.x, orientation.y, orientation.z, orientation.w
    )
    return Angles(*parts)


def enu_quaternion_to_ned_heading(orientation: QuaternionLike) -> float:
    """Orientation of a body in east-north-up to its heading clockwise from north, in [-pi, pi].

    A quaternion of length zero is no orientation: the result is not a number.
    """
    return rotations.enu_quaternion_to_ned_heading(
        orientation.x, orientation.y, orientation.z, orientation.w
    )
