"""A message of each measured map, as both sides carry it."""

from __future__ import annotations

import array
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import interpreting
from names import KINDS
from rclpy.serialization import serialize_message

from jausml.language.metamodel.classes import bridge
from jausml.live.messages import Catalogue

if TYPE_CHECKING:
    from jausml.language.model import Model

_TIME = {"seconds": 1_700_000_000, "nanoseconds": 123_456_789}
_RATES = {"vx": 1.25, "vy": -0.5, "yaw_rate": 0.25}
_ANGLES = {"roll": 0.01, "pitch": -0.02, "yaw": 0.7}
_POSITION = {"x": 12.5, "y": -3.25, "z": 0.75}
_GRIDS = {"grid": (200, 200), "large": (300, 200)}


@dataclass(frozen=True)
class Sample:
    """A message.

    Attributes:
        kind: One of `KINDS`.
        map: The map that carries it.
        jaus: Encoded JAUS message.
        ros: Encoded ROS message.
        ros_class: Class of the ROS message.
    """

    kind: str
    map: str
    jaus: bytes
    ros: bytes
    ros_class: Any

    @property
    def type(self) -> str:
        """Name of the ROS type, such as `geometry_msgs/PointStamped`."""
        return f"{self.ros_class.__module__.partition('.')[0]}/{self.ros_class.__name__}"


def jaus_fields(kind: str) -> dict[str, Any]:
    """Returns the fields of the JAUS message of a kind."""
    match kind:
        case "point" | "report":
            return {**_TIME, **_POSITION}
        case "twist":
            return {**_TIME, **_RATES, "vz": 0.1, "roll_rate": 0.0, "pitch_rate": -0.1}
        case "odometry":
            frames = {"frame": "odom", "child_frame": "base_link"}
            return {**_TIME, **frames, **_POSITION, **_ANGLES, **_RATES}
        case "scan":
            beams = [{"value": 5 + 4 * math.sin(0.1 * n)} for n in range(360)]
            return {**_TIME, "start": -math.pi, "step": math.tau / 360, "distances": beams}
        case "path":
            poses = [
                {**_POSITION, **_ANGLES, "x": 0.5 * n, "yaw": 0.03 * n - 1.5} for n in range(100)
            ]
            return {**_TIME, "poses": poses}
    width, height = _GRIDS[kind]
    cells = [{"value": 254 * (n % 101) // 100} for n in range(width * height)]
    return {**_TIME, "width": width, "height": height, "resolution": 0.05, "cells": cells}


def sample(model: Model, kind: str) -> Sample:
    """Returns the message of a kind, made without generated code.

    Args:
        model: A measured system.
        kind: One of `KINDS`, or the map of reports.
    """
    map_name = KINDS[kind][0] if kind in KINDS else kind
    attribute_map = next(
        each for each in model.instances(bridge.AttributeMap) if each.name == map_name
    )
    entry = Catalogue(model).message(str(attribute_map.message.name))
    jaus = entry.encode({str(attribute_map.message.body.name): jaus_fields(kind)})
    message = interpreting.Interpreter(attribute_map, entry, "up").to_ros(jaus)
    if isinstance(getattr(message, "data", None), list):
        message.data = array.array("b", message.data)
    return Sample(kind, map_name, jaus, serialize_message(message), type(message))
