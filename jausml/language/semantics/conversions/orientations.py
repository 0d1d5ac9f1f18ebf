"""Conversions of angles, and between angles and orientations.

An orientation is x, y, z and w of a quaternion: the product of the turns about single axes, roll
about x, then pitch about y, then yaw about z.
"""

from __future__ import annotations

import math
from typing import ClassVar

from jausml.language.attributes.intervals import Interval
from jausml.language.semantics.conversions.conversion import (
    DEGREE,
    ENU,
    FLU,
    FRD,
    NED,
    ONE,
    RADIAN,
    TURN,
    Conversion,
    Effect,
)
from jausml.language.semantics.conversions.definition import QUATERNION, Definition
from jausml.language.semantics.paths.attributes import NUMBER

QUARTER = (-math.pi / 2, math.pi / 2)


class DegreesToRadians(Conversion):
    """Degrees to radians."""

    name = "degrees_to_radians"
    units = (DEGREE, RADIAN)
    inverse = "radians_to_degrees"
    effect = Effect.LINEAR
    definition = Definition("value", "value * (pi / 180)")


class RadiansToDegrees(Conversion):
    """Radians to degrees."""

    name = "radians_to_degrees"
    units = (RADIAN, DEGREE)
    inverse = "degrees_to_radians"
    effect = Effect.LINEAR
    definition = Definition("value", "value * (180 / pi)")


class NedHeadingToEnuYaw(Conversion):
    """Heading clockwise from north to yaw counter-clockwise from east, wrapped to [-pi, pi]."""

    name = "ned_heading_to_enu_yaw"
    units = (RADIAN, RADIAN)
    frames = (NED, ENU)
    takes_axes = gives_axes = ("z",)
    inverse = "enu_yaw_to_ned_heading"
    limits = (TURN,)
    definition = Definition(
        "value",
        """
        yaw = pi / 2 - value
        if(isfinite(yaw), remainder(yaw, 2 * pi), nan)
        """,
    )


class EnuYawToNedHeading(Conversion):
    """Yaw counter-clockwise from east to heading clockwise from north, wrapped to [-pi, pi]."""

    name = "enu_yaw_to_ned_heading"
    units = (RADIAN, RADIAN)
    frames = (ENU, NED)
    takes_axes = gives_axes = ("z",)
    inverse = "ned_heading_to_enu_yaw"
    limits = (TURN,)
    definition = Definition(
        "value",
        """
        heading = pi / 2 - value
        if(isfinite(heading), remainder(heading, 2 * pi), nan)
        """,
    )


class WrapAngle(Conversion):
    """An angle in radians wrapped to [-pi, pi]."""

    name = "wrap_angle"
    units = (RADIAN, RADIAN)
    limits = (TURN,)
    effect = Effect.SAME
    definition = Definition("value", "if(isfinite(value), remainder(value, 2 * pi), nan)")


# The turn about one axis, or about all of them, by half angles; an infinite angle gives none.
_TURN = """
        half_z = if(isfinite(about_z), about_z / 2, nan)
        0
        0
        sin(half_z)
        cos(half_z)
        """
_TURNS = """
        half_x = if(isfinite(about_x), about_x / 2, nan)
        half_y = if(isfinite(about_y), about_y / 2, nan)
        half_z = if(isfinite(about_z), about_z / 2, nan)
        sin_x = sin(half_x)
        cos_x = cos(half_x)
        sin_y = sin(half_y)
        cos_y = cos(half_y)
        sin_z = sin(half_z)
        cos_z = cos(half_z)
        sin_x * cos_y * cos_z - cos_x * sin_y * sin_z
        cos_x * sin_y * cos_z + sin_x * cos_y * sin_z
        cos_x * cos_y * sin_z - sin_x * sin_y * cos_z
        cos_x * cos_y * cos_z + sin_x * sin_y * sin_z
        """
# Roll, pitch and yaw of the same turn about right and down, the axes of forward-right-down.
# Near the vertical, roll and yaw turn about the same axis, and roll is taken as zero.
_ANGLES_OF = """
        right = -y
        down = -z
        squared_length = x * x + right * right + down * down + w * w
        sine = if(squared_length == 0, nan, 2 * (w * right - down * x) / squared_length)
        vertical = 1 - 1e-12
        is_level = sine >= -vertical and sine <= vertical
        up_left = 2 * (w * x + right * down)
        up_up = w * w - x * x - right * right + down * down
        roll = if(is_level, atan2(up_left, up_up), if(sine == sine, 0, nan))
        pitch = asin(max(-1, min(1, sine)))
        level = atan2(2 * (w * down + x * right), w * w + x * x - right * right - down * down)
        steep = atan2(-2 * (x * right - w * down), w * w - x * x + right * right - down * down)
        yaw = if(is_level, level, if(sine == sine, steep, nan))
        """


class _ToOrientation(Conversion):
    outputs = (QUATERNION,)
    units = (RADIAN, ONE)
    gives_axes = ("",)


class _ToOneAngle(Conversion):
    inputs = (QUATERNION,)
    units = (ONE, RADIAN)
    takes_axes = ("",)
    limits: ClassVar[tuple[Interval, ...]] = (TURN,)


class _ToAngles(_ToOneAngle):
    outputs = (NUMBER, NUMBER, NUMBER)
    gives_axes = ("x", "y", "z")
    limits = (TURN, QUARTER, TURN)


class FrdAnglesToFluQuaternion(_ToOrientation):
    """Roll, pitch and yaw about forward-right-down axes to an orientation in forward-left-up."""

    name = "frd_angles_to_flu_quaternion"
    inputs = (NUMBER, NUMBER, NUMBER)
    frames = (FRD, FLU)
    takes_axes = ("x", "y", "z")
    inverse = "flu_quaternion_to_frd_angles"
    definition = Definition(
        "roll, pitch, yaw",
        """
        about_x = roll
        about_y = -pitch
        about_z = -yaw
        """
        + _TURNS,
    )


class FrdYawToFluQuaternion(_ToOrientation):
    """Yaw about the down axis alone to an orientation in forward-left-up."""

    name = "frd_yaw_to_flu_quaternion"
    frames = (FRD, FLU)
    takes_axes = ("z",)
    inverse = "flu_quaternion_to_frd_yaw"
    definition = Definition("yaw", "about_z = -yaw" + _TURN)


class FluQuaternionToFrdRoll(_ToOneAngle):
    """Orientation in forward-left-up to roll about forward-right-down axes."""

    name = "flu_quaternion_to_frd_roll"
    frames = (FLU, FRD)
    gives_axes = ("x",)
    definition = Definition("x, y, z, w", _ANGLES_OF + "roll")


class FluQuaternionToFrdPitch(_ToOneAngle):
    """Orientation in forward-left-up to pitch about forward-right-down axes."""

    name = "flu_quaternion_to_frd_pitch"
    frames = (FLU, FRD)
    gives_axes = ("y",)
    limits = (QUARTER,)
    definition = Definition("x, y, z, w", _ANGLES_OF + "pitch")


class FluQuaternionToFrdYaw(_ToOneAngle):
    """Orientation in forward-left-up to yaw about forward-right-down axes."""

    name = "flu_quaternion_to_frd_yaw"
    frames = (FLU, FRD)
    gives_axes = ("z",)
    inverse = "frd_yaw_to_flu_quaternion"
    definition = Definition("x, y, z, w", _ANGLES_OF + "yaw")


class FluQuaternionToFrdAngles(_ToAngles):
    """Orientation in forward-left-up to roll, pitch and yaw about forward-right-down axes."""

    name = "flu_quaternion_to_frd_angles"
    frames = (FLU, FRD)
    inverse = "frd_angles_to_flu_quaternion"
    definition = Definition(
        "x, y, z, w",
        _ANGLES_OF
        + """
        roll
        pitch
        yaw
        """,
    )


class NedAnglesToEnuQuaternion(_ToOrientation):
    """Roll, pitch and heading in north-east-down to an orientation in east-north-up."""

    name = "ned_angles_to_enu_quaternion"
    inputs = (NUMBER, NUMBER, NUMBER)
    frames = (NED, ENU)
    takes_axes = ("x", "y", "z")
    inverse = "enu_quaternion_to_ned_angles"
    definition = Definition(
        "roll, pitch, heading",
        """
        about_x = roll
        about_y = -pitch
        about_z = pi / 2 - heading
        """
        + _TURNS,
    )


class NedHeadingToEnuQuaternion(_ToOrientation):
    """Heading clockwise from north alone to the orientation of a level body in east-north-up."""

    name = "ned_heading_to_enu_quaternion"
    frames = (NED, ENU)
    takes_axes = ("z",)
    inverse = "enu_quaternion_to_ned_heading"
    definition = Definition("heading", "about_z = pi / 2 - heading" + _TURN)


class EnuQuaternionToNedHeading(_ToOneAngle):
    """Orientation of a body in east-north-up to its heading clockwise from north."""

    name = "enu_quaternion_to_ned_heading"
    frames = (ENU, NED)
    gives_axes = ("z",)
    inverse = "ned_heading_to_enu_quaternion"
    definition = Definition("x, y, z, w", _ANGLES_OF + "remainder(pi / 2 + yaw, 2 * pi)")


class EnuQuaternionToNedAngles(_ToAngles):
    """Orientation of a forward-left-up body in east-north-up to its angles in north-east-down.

    They are roll, pitch and heading of the same body, as forward-right-down.
    """

    name = "enu_quaternion_to_ned_angles"
    frames = (ENU, NED)
    inverse = "ned_angles_to_enu_quaternion"
    definition = Definition(
        "x, y, z, w",
        _ANGLES_OF
        + """
        roll
        pitch
        remainder(pi / 2 + yaw, 2 * pi)
        """,
    )
