"""The ward of a bridge: registers stops of ROS topics and goals with its guardian process."""

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
    """Registers stops with the guardian as encoded messages, which it only has to send."""

    def __init__(
        self, loop: Loop, node: RosSide, line: Sequence[str], on_stop: Callable[[], None]
    ) -> None:
        """Starts no process yet.

        Args:
            line: Command line of the bridge, for its enclave.
            on_stop: Called when the guardian has sent the stops.
        """

        def simulated_time() -> int:
            seconds, nanoseconds = node.now() if node.is_simulated else (0, 0)
            return seconds * 10**9 + nanoseconds

        super().__init__(loop, lambda: _ros_settings(line), simulated_time, on_stop)

    def topic_stops(self, publishers: Iterable[RosPublisher], data: bytes) -> list[Content]:
        """Returns the content for the guardian of a stop on topics; `data` has `Ward.moment`."""
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
        """Registers a goal before it is sent; `service` is that which cancels it."""
        self.open_goal(goal, service, _type_library("action_msgs"))


@cache
def _type_library(package: str) -> str:
    """Returns the path of the loaded library with the types of a package."""
    return loaded_libraries()[f"lib{package}__rosidl_typesupport_c.so"]


def _ros_settings(line: Sequence[str]) -> Content:
    """Returns the libraries and arguments by which the guardian joins ROS like this process."""
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
    """Yields the positions of `Ward.moment` in a serialized message."""
    position = data.find(_MARK)
    while position >= 0:
        yield position
        position = data.find(_MARK, position + len(_MARK))
