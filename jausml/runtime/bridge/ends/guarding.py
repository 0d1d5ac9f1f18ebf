"""What a bridge hands to its guardian: its stops, as octets with which nothing is left to do."""

from __future__ import annotations

import struct
from dataclasses import asdict
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ...conversions import Time
from ...guardian.rcl import loaded_libraries

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from .ros_side import RosPublisher

MARK = Time(0x01020304, 0x05060708)
"""The moment that stops are made for: where it stands in them, the guardian puts the present."""

_MARK = struct.pack("<iI", *MARK)


def topic_stops(publishers: Iterable[RosPublisher], data: bytes) -> list[dict[str, Any]]:
    """Returns for each topic a stop that was made for the moment `MARK`."""
    return [
        {
            "topic": publisher.published.topic,
            "type": publisher.published.type,
            "library": type_library(publisher.published.type.partition("/")[0]),
            "qos": asdict(publisher.published.qos),
            "data": data.hex(),
            "stamps": list(_stamps(data)),
        }
        for publisher in publishers
    ]


@cache
def type_library(package: str) -> str:
    """Returns the path of the library that has the type support of a package.

    Raises:
        KeyError: Nothing of it is in use.
    """
    return loaded_libraries()[f"lib{package}__rosidl_typesupport_c.so"]


def ros_of(arguments: Sequence[str]) -> dict[str, Any]:
    """Returns what the guardian needs to speak ROS."""
    paths = loaded_libraries()
    words = list(arguments)
    options = ("-e", "--enclave")
    enclave = [
        word
        for option, value in pairwise(words)
        if option in options
        for word in ("--ros-args", option, value)
    ]
    libraries = {"rcl": paths["librcl.so"], "utilities": paths["librcutils.so"]}
    return {**libraries, "arguments": enclave}


def _stamps(data: bytes) -> Iterator[int]:
    """Yields where stamps stand in a serialized message."""
    position = data.find(_MARK)
    while position >= 0:
        yield position
        position = data.find(_MARK, position + len(_MARK))
