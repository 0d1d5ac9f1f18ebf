"""Conversions of one angle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.semantics.conversions.conversion import (
    DEGREE,
    ENU,
    NED,
    RADIAN,
    TURN,
    Conversion,
    Definition,
    Effect,
    linear_interval,
)

if TYPE_CHECKING:
    from jausml.language.attributes.intervals import Interval


def _direction(angle: float) -> float:
    """The angle of the vector that an angle points to, in [-pi, pi]."""
    if not math.isfinite(angle):
        return math.nan
    return math.atan2(math.sin(angle), math.cos(angle))


class DegreesToRadians(Conversion):
    """Degrees to radians."""

    name = "degrees_to_radians"
    units = (DEGREE, RADIAN)
    inverse = "radians_to_degrees"
    effect = Effect.LINEAR
    definition = Definition("value", "value * (pi / 180)")

    def forward(self, value: float) -> float:
        """By half a turn."""
        return value * math.pi / 180

    def interval(self, value: Interval) -> Interval:
        """Both ends."""
        return linear_interval(value, math.radians(1.0))


class RadiansToDegrees(Conversion):
    """Radians to degrees."""

    name = "radians_to_degrees"
    units = (RADIAN, DEGREE)
    inverse = "degrees_to_radians"
    effect = Effect.LINEAR
    definition = Definition("value", "value * (180 / pi)")

    def forward(self, value: float) -> float:
        """By half a turn."""
        return value * 180 / math.pi

    def interval(self, value: Interval) -> Interval:
        """Both ends."""
        return linear_interval(value, math.degrees(1.0))


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

    def forward(self, value: float) -> float:
        """The rest to a quarter turn."""
        return _direction(math.pi / 2 - value)


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

    def forward(self, value: float) -> float:
        """The rest to a quarter turn."""
        return _direction(math.pi / 2 - value)


class WrapAngle(Conversion):
    """An angle in radians wrapped to [-pi, pi]."""

    name = "wrap_angle"
    units = (RADIAN, RADIAN)
    limits = (TURN,)
    effect = Effect.SAME
    definition = Definition("value", "if(isfinite(value), remainder(value, 2 * pi), nan)")

    def forward(self, value: float) -> float:
        """The angle of the vector that it points to."""
        return _direction(value)


CONVERSIONS = (
    DegreesToRadians(),
    RadiansToDegrees(),
    NedHeadingToEnuYaw(),
    EnuYawToNedHeading(),
    WrapAngle(),
)
