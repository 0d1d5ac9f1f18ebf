"""Orientations and times of the samples, computed a second time and independently of the runtime.

Orientations are products of the turns about single axes, in the order roll, pitch, yaw from the
right; the body is forward-left-up where nothing else is said.
"""

from __future__ import annotations

import math
from datetime import datetime, timezone
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

Parts = tuple[float, float, float, float]

ROLL, PITCH, YAW = 0.125, 0.25, 0.375
"""Angles about the axes of ROS of the orientation that samples have."""
MOMENT = datetime(2024, 2, 29, 23, 59, 58, 987_000, tzinfo=timezone.utc)
"""The time that samples have."""
STAMP = {
    "Milliseconds": 987,
    "Seconds": 58,
    "Minutes": 59,
    "Hour": 23,
    "Day": 29,
}
"""The same as a JAUS TimeStamp."""


def _turn(axis: int, angle: float) -> Parts:
    parts = [0.0, 0.0, 0.0, math.cos(angle / 2)]
    parts[axis] = math.sin(angle / 2)
    return parts[0], parts[1], parts[2], parts[3]


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


def orientation(roll: float, pitch: float, yaw: float) -> Parts:
    """Returns x, y, z and w of the orientation with some angles."""
    return _times(_turn(2, yaw), _times(_turn(1, pitch), _turn(0, roll)))


_TO_ORIENTATION: dict[str, Callable[..., Parts]] = {
    "frd_angles_to_flu_quaternion": lambda r, p, y: orientation(r, -p, -y),
    "frd_yaw_to_flu_quaternion": lambda y: orientation(0.0, 0.0, -y),
    "ned_angles_to_enu_quaternion": lambda r, p, h: orientation(r, -p, math.pi / 2 - h),
    "ned_heading_to_enu_quaternion": lambda h: orientation(0.0, 0.0, math.pi / 2 - h),
}
_OF_ORIENTATION: dict[str, tuple[float, ...]] = {
    "flu_quaternion_to_frd_roll": (ROLL,),
    "flu_quaternion_to_frd_pitch": (-PITCH,),
    "flu_quaternion_to_frd_yaw": (-YAW,),
    "flu_quaternion_to_frd_angles": (ROLL, -PITCH, -YAW),
    "enu_quaternion_to_ned_angles": (ROLL, -PITCH, math.pi / 2 - YAW),
    "enu_quaternion_to_ned_heading": (math.pi / 2 - YAW,),
}
TO_TIME, TO_STAMP = "timestamp_to_time", "time_to_timestamp"
SPATIAL = {*_TO_ORIENTATION, *_OF_ORIENTATION, TO_TIME, TO_STAMP}
"""The conversions that fail for no orientation and no time of a sample."""


def orientation_of(kind: str, angles: tuple[float, ...]) -> dict[str, float]:
    """Returns the parts of the orientation that a conversion yields; none for other conversions."""
    made = _TO_ORIENTATION.get(kind)
    return {} if made is None else dict(zip("xyzw", made(*angles), strict=True))


def angles_of_sample(kind: str) -> tuple[float, ...]:
    """Returns what a conversion yields of the orientation of samples; nothing for others."""
    return _OF_ORIENTATION.get(kind, ())
