"""Conversions between angles and orientations.

An orientation is x, y, z and w of a quaternion, made here as the product of the turns about single
axes: roll about x, then pitch about y, then yaw about z. Its angles are read from where it turns
the axes of the body. The runtime computes both by formulas of the half angles and of the parts.
"""

from __future__ import annotations

import math

from jausml.language.semantics.conversions.conversion import (
    ENU,
    FLU,
    FRD,
    NED,
    ONE,
    QUATERNION,
    RADIAN,
    TURN,
    Conversion,
    Definition,
    Effect,
)
from jausml.language.semantics.paths.attributes import NUMBER

QUARTER = (-math.pi / 2, math.pi / 2)

Parts = tuple[float, float, float, float]
Triple = tuple[float, float, float]

_ORIENTATION = ("",)
_ANGLES = ("x", "y", "z")
# Closer to vertical than this, roll and yaw turn about the same axis, and roll is taken as zero.
_VERTICAL = 1.0 - 1e-12

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


def orientation(roll: float, pitch: float, yaw: float) -> Parts:
    """Returns x, y, z and w of the orientation that turns by some angles."""
    return _times(_turn(2, yaw), _times(_turn(1, pitch), _turn(0, roll)))


def angles(parts: Parts) -> Triple:
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


def _turn(axis: int, angle: float) -> Parts:
    parts = [0.0, 0.0, 0.0, math.cos(angle / 2)]
    parts[axis] = math.sin(angle / 2)
    return parts[0], parts[1], parts[2], parts[3]


def _turned(parts: Parts, axis: int) -> Triple:
    """Where an orientation of length one turns the vector of an axis."""
    x, y, z, w = parts
    vector = [0.0, 0.0, 0.0, 0.0]
    vector[axis] = 1.0
    turned = _times(_times(parts, (vector[0], vector[1], vector[2], 0.0)), (-x, -y, -z, w))
    return turned[:3]


def _times(a: Parts, b: Parts) -> Parts:
    """Hamilton product: first the turn `b`, then `a`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _heading(yaw: float) -> float:
    """The heading of a yaw, in [-pi, pi]."""
    return math.atan2(math.cos(yaw), math.sin(yaw))


class OrientationIfKnown(Conversion):
    """The orientation, or one of length zero where the variance beside it is negative.

    A first variance of -1 says in sensor_msgs/Imu that the orientation is unknown. One of length
    zero has no angles: what is made of it is not a number.
    """

    name = "orientation_if_known"
    inputs = (QUATERNION, NUMBER)
    outputs = (QUATERNION,)
    effect = Effect.SAME
    definition = Definition(
        "x, y, z, w, variance",
        """
        if(variance < 0, 0, x)
        if(variance < 0, 0, y)
        if(variance < 0, 0, z)
        if(variance < 0, 0, w)
        """,
    )

    def forward(self, parts: Parts, variance: float) -> Parts:
        """All parts, or none of them."""
        return (0.0, 0.0, 0.0, 0.0) if variance < 0 else parts


class FrdAnglesToFluQuaternion(Conversion):
    """Roll, pitch and yaw about forward-right-down axes to an orientation in forward-left-up."""

    name = "frd_angles_to_flu_quaternion"
    inputs = (NUMBER, NUMBER, NUMBER)
    outputs = (QUATERNION,)
    units = (RADIAN, ONE)
    frames = (FRD, FLU)
    takes_axes, gives_axes = _ANGLES, _ORIENTATION
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

    def forward(self, roll: float, pitch: float, yaw: float) -> Parts:
        """The product of the three turns, two of them the other way round."""
        return orientation(roll, -pitch, -yaw)


class FrdYawToFluQuaternion(Conversion):
    """Yaw about the down axis alone to an orientation in forward-left-up."""

    name = "frd_yaw_to_flu_quaternion"
    outputs = (QUATERNION,)
    units = (RADIAN, ONE)
    frames = (FRD, FLU)
    takes_axes, gives_axes = ("z",), _ORIENTATION
    inverse = "flu_quaternion_to_frd_yaw"
    definition = Definition("yaw", "about_z = -yaw" + _TURN)

    def forward(self, yaw: float) -> Parts:
        """The turn the other way round."""
        return orientation(0.0, 0.0, -yaw)


class FluQuaternionToFrdRoll(Conversion):
    """Orientation in forward-left-up to roll about forward-right-down axes."""

    name = "flu_quaternion_to_frd_roll"
    inputs = (QUATERNION,)
    units = (ONE, RADIAN)
    frames = (FLU, FRD)
    takes_axes, gives_axes = _ORIENTATION, ("x",)
    limits = (TURN,)
    definition = Definition("x, y, z, w", _ANGLES_OF + "roll")

    def forward(self, parts: Parts) -> float:
        """How far left is above right."""
        return angles(parts)[0]


class FluQuaternionToFrdPitch(Conversion):
    """Orientation in forward-left-up to pitch about forward-right-down axes."""

    name = "flu_quaternion_to_frd_pitch"
    inputs = (QUATERNION,)
    units = (ONE, RADIAN)
    frames = (FLU, FRD)
    takes_axes, gives_axes = _ORIENTATION, ("y",)
    limits = (QUARTER,)
    definition = Definition("x, y, z, w", _ANGLES_OF + "pitch")

    def forward(self, parts: Parts) -> float:
        """How far forward points up."""
        return -angles(parts)[1]


class FluQuaternionToFrdYaw(Conversion):
    """Orientation in forward-left-up to yaw about forward-right-down axes."""

    name = "flu_quaternion_to_frd_yaw"
    inputs = (QUATERNION,)
    units = (ONE, RADIAN)
    frames = (FLU, FRD)
    takes_axes, gives_axes = _ORIENTATION, ("z",)
    inverse = "frd_yaw_to_flu_quaternion"
    limits = (TURN,)
    definition = Definition("x, y, z, w", _ANGLES_OF + "yaw")

    def forward(self, parts: Parts) -> float:
        """How far forward points to the right."""
        return -angles(parts)[2]


class FluQuaternionToFrdAngles(Conversion):
    """Orientation in forward-left-up to roll, pitch and yaw about forward-right-down axes."""

    name = "flu_quaternion_to_frd_angles"
    inputs = (QUATERNION,)
    outputs = (NUMBER, NUMBER, NUMBER)
    units = (ONE, RADIAN)
    frames = (FLU, FRD)
    takes_axes, gives_axes = _ORIENTATION, _ANGLES
    inverse = "frd_angles_to_flu_quaternion"
    limits = (TURN, QUARTER, TURN)
    definition = Definition(
        "x, y, z, w",
        _ANGLES_OF
        + """
        roll
        pitch
        yaw
        """,
    )

    def forward(self, parts: Parts) -> Triple:
        """The three angles, two of them the other way round."""
        roll, pitch, yaw = angles(parts)
        return roll, -pitch, -yaw


class NedAnglesToEnuQuaternion(Conversion):
    """Roll, pitch and heading in north-east-down to an orientation in east-north-up."""

    name = "ned_angles_to_enu_quaternion"
    inputs = (NUMBER, NUMBER, NUMBER)
    outputs = (QUATERNION,)
    units = (RADIAN, ONE)
    frames = (NED, ENU)
    takes_axes, gives_axes = _ANGLES, _ORIENTATION
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

    def forward(self, roll: float, pitch: float, heading: float) -> Parts:
        """The product of the three turns, the last one from east."""
        return orientation(roll, -pitch, math.pi / 2 - heading)


class NedHeadingToEnuQuaternion(Conversion):
    """Heading clockwise from north alone to the orientation of a level body in east-north-up."""

    name = "ned_heading_to_enu_quaternion"
    outputs = (QUATERNION,)
    units = (RADIAN, ONE)
    frames = (NED, ENU)
    takes_axes, gives_axes = ("z",), _ORIENTATION
    inverse = "enu_quaternion_to_ned_heading"
    definition = Definition("heading", "about_z = pi / 2 - heading" + _TURN)

    def forward(self, heading: float) -> Parts:
        """The turn from east."""
        return orientation(0.0, 0.0, math.pi / 2 - heading)


class EnuQuaternionToNedHeading(Conversion):
    """Orientation of a body in east-north-up to its heading clockwise from north."""

    name = "enu_quaternion_to_ned_heading"
    inputs = (QUATERNION,)
    units = (ONE, RADIAN)
    frames = (ENU, NED)
    takes_axes, gives_axes = _ORIENTATION, ("z",)
    inverse = "ned_heading_to_enu_quaternion"
    limits = (TURN,)
    definition = Definition("x, y, z, w", _ANGLES_OF + "remainder(pi / 2 + yaw, 2 * pi)")

    def forward(self, parts: Parts) -> float:
        """How far forward points east of north."""
        return _heading(angles(parts)[2])


class EnuQuaternionToNedAngles(Conversion):
    """Orientation of a forward-left-up body in east-north-up to its angles in north-east-down.

    They are roll, pitch and heading of the same body, as forward-right-down.
    """

    name = "enu_quaternion_to_ned_angles"
    inputs = (QUATERNION,)
    outputs = (NUMBER, NUMBER, NUMBER)
    units = (ONE, RADIAN)
    frames = (ENU, NED)
    takes_axes, gives_axes = _ORIENTATION, _ANGLES
    inverse = "ned_angles_to_enu_quaternion"
    limits = (TURN, QUARTER, TURN)
    definition = Definition(
        "x, y, z, w",
        _ANGLES_OF
        + """
        roll
        pitch
        remainder(pi / 2 + yaw, 2 * pi)
        """,
    )

    def forward(self, parts: Parts) -> Triple:
        """Roll, pitch the other way round, and the heading."""
        roll, pitch, yaw = angles(parts)
        return roll, -pitch, _heading(yaw)


CONVERSIONS = (
    OrientationIfKnown(),
    FrdAnglesToFluQuaternion(),
    FrdYawToFluQuaternion(),
    FluQuaternionToFrdRoll(),
    FluQuaternionToFrdPitch(),
    FluQuaternionToFrdYaw(),
    FluQuaternionToFrdAngles(),
    NedAnglesToEnuQuaternion(),
    NedHeadingToEnuQuaternion(),
    EnuQuaternionToNedHeading(),
    EnuQuaternionToNedAngles(),
)
