"""Types of the inputs and results of conversions.

Inputs are protocols of attributes, so that conversions import no messages of either side; results
are named tuples with the same attributes.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ..base.api import JausError


class ConversionError(JausError):
    """A value has no counterpart on the other side."""


class QuaternionLike(Protocol):
    """The attributes of geometry_msgs/Quaternion."""

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
    """The attributes of builtin_interfaces/Time."""

    @property
    def sec(self) -> int:
        """Seconds since 1970-01-01 UTC."""

    @property
    def nanosec(self) -> int:
        """Nanoseconds within the second."""


class TimeStampLike(Protocol):
    """The attributes of the TimeStamp of a JAUS report (AS6009)."""

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


class Angles(NamedTuple):
    """Roll, pitch and yaw in radians: turns about x, then y, then z; yaw may be a heading."""

    roll: float
    pitch: float
    yaw: float


class Pixels(NamedTuple):
    """The pixels of an image, with the attributes of sensor_msgs/Image."""

    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: bytes
