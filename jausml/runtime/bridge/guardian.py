"""The guardian of a bridge, for models with something to stop: it speaks ROS besides JAUS."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from functools import cache
from itertools import pairwise

from ..base.loop import Loop
from ..guardian.rcl import loaded_libraries
from ..guardian.ward import Content, Ward
from .ends.ros_side import RosPublisher, RosSide

_MARK = struct.pack("<iI", *Ward.moment)


class Guardian(Ward):
    """What a bridge tells its guardian, in octets with which nothing is left to do."""

    def __init__(
        self, loop: Loop, node: RosSide, line: Sequence[str], taken: Callable[[], None]
    ) -> None:
        def simulated() -> int:
            seconds, nanoseconds = node.now() if node.is_simulated else (0, 0)
            return seconds * 10**9 + nanoseconds

        super().__init__(loop, lambda: _ros_of(line), simulated, taken)

    def topic_stops(self, publishers: Iterable[RosPublisher], data: bytes) -> list[Content]:
        """Returns for each topic a stop that was made for the moment of stops."""
        return [
            {
                "topic": publisher.published.topic,
                "type": publisher.published.type,
                "library": _type_library(publisher.published.type.partition("/")[0]),
                "qos": asdict(publisher.published.qos),
                "data": data.hex(),
                "stamps": list(_stamps(data)),
            }
            for publisher in publishers
        ]

    def guard_goal(self, goal: bytes, service: str) -> None:
        """Hands a goal over, before it is sent; the service cancels it."""
        self.open_goal(goal, service, _type_library("action_msgs"))


@cache
def _type_library(package: str) -> str:
    """Returns the path of the library, which is in use, that has the types of a package."""
    return loaded_libraries()[f"lib{package}__rosidl_typesupport_c.so"]


def _ros_of(line: Sequence[str]) -> Content:
    """Returns what the guardian needs to speak ROS as a process with a command line does."""
    paths = loaded_libraries()
    enclave = [
        word
        for option, value in pairwise(line)
        if option in ("-e", "--enclave")
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
