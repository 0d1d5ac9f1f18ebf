"""Age of a message that arrives: by its stamp, or else by the time of its publication.

Stamps are those of other computers. An age means something while their clocks agree with the ROS
clock of the bridge.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

from ...conversions import ConversionError, Time, timestamp_to_time
from ...wire.message import DecodeError
from ..light_message import is_light
from ..messages import cdr

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...wire.message import Message
    from ..ends.ends import RosSide

Age: TypeAlias = Callable[[bytes, Any], "float | None"]
"""Returns the seconds since a message with its origin was made; None when nothing tells them."""

_STAMPS = {cdr.LITTLE: struct.Struct("<iI"), cdr.BIG: struct.Struct(">iI")}
_STAMPED = {("header", "std_msgs/Header"), ("stamp", "builtin_interfaces/Time")}
_NANO = 10**9


def ros_age(ros_type: type[Any], ros: RosSide, wall: Callable[[], int]) -> Age:
    """Returns what tells the age of messages of a ROS type.

    That is the one of its stamp by the ROS clock; of a type or message without one, that of its
    publication, which the publisher tells by the clock of its computer.

    Args:
        wall: Tells the time of day in nanoseconds since 1970, as publishers do.
    """
    is_stamped = _begins_with_stamp(ros_type)

    def age(data: bytes, origin: int) -> float | None:
        stamp = _first_stamp(data) if is_stamped else 0
        if stamp:
            return (_nanoseconds(ros.now()) - stamp) / _NANO
        return (wall() - origin) / _NANO if origin else None

    return age


def jaus_age(message_type: type[Message], ros: RosSide) -> Age:
    """Returns what tells the age of a JAUS message by its TimeStamp and the ROS clock."""

    def age(data: bytes, _origin: object) -> float | None:
        try:
            stamp = getattr(message_type.decode(data), "time_stamp", None)
            if stamp is None:
                return None
            now = ros.now()
            sent = timestamp_to_time(stamp, near=now)
        except (DecodeError, ConversionError):
            return None  # whoever translates the message says what is wrong with it
        return (_nanoseconds(now) - _nanoseconds(sent)) / _NANO

    return age


def _begins_with_stamp(ros_type: type[Any]) -> bool:
    if is_light(ros_type):
        layout: Mapping[str, str] = ros_type.LAYOUT
    else:
        layout = ros_type.get_fields_and_field_types()
    return next(iter(layout.items()), None) in _STAMPED


def _first_stamp(data: bytes) -> int:
    """Returns the stamp that a message begins with in nanoseconds, 0 if nobody filled it."""
    order = cdr.ORDERS.get(data[:2])
    if order is None or len(data) < len(cdr.HEADER) + 8:
        return 0
    seconds, nanoseconds = _STAMPS[order].unpack_from(data, len(cdr.HEADER))
    return int(seconds) * _NANO + int(nanoseconds)


def _nanoseconds(moment: Time) -> int:
    return moment.sec * _NANO + moment.nanosec
