"""A message of each measured map, as both sides carry it."""

from __future__ import annotations

import array
import math
from dataclasses import dataclass
from typing import Any

from ends import message_class
from names import KINDS
from rclpy.serialization import serialize_message

from jausml.language.metamodel.classes import bridge
from jausml.language.model import Model
from jausml.live.messages.defined import DefinedCatalogue

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
        case "point":
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


def ros_message(kind: str, ros_class: Any) -> Any:
    """Returns the ROS message of a kind, with as many elements as that of JAUS has."""
    message = ros_class()
    message.header.stamp.sec, message.header.stamp.nanosec = _TIME.values()
    message.header.frame_id = "odom"
    match kind:
        case "point":
            message.point.x, message.point.y, message.point.z = _POSITION.values()
        case "twist":
            message.twist.linear.x, message.twist.angular.z = _RATES["vx"], _RATES["yaw_rate"]
        case "odometry":
            message.child_frame_id = "base_link"
            message.pose.pose.orientation.z = math.sin(_ANGLES["yaw"] / 2)
            message.pose.pose.orientation.w = math.cos(_ANGLES["yaw"] / 2)
            message.twist.twist.linear.x = _RATES["vx"]
        case "scan":
            message.angle_min, message.angle_increment = -math.pi, math.tau / 360
            message.ranges = [5 + 4 * math.sin(0.1 * n) for n in range(360)]
        case "path":
            pose_class = message_class("geometry_msgs/PoseStamped")
            message.poses = [pose_class(header=message.header) for _ in range(100)]
            for n, pose in enumerate(message.poses):
                pose.pose.position.x = 0.5 * n
                pose.pose.orientation.z = math.sin(0.015 * n)
                pose.pose.orientation.w = math.cos(0.015 * n)
        case _:
            message.info.width, message.info.height = _GRIDS[kind]
            message.info.resolution = 0.05
            cells = message.info.width * message.info.height
            message.data = array.array("b", [n % 101 for n in range(cells)])
    return message


def sample(model: Model, kind: str) -> Sample:
    """Returns the message of a kind, made without generated code.

    Args:
        model: A measured system.
        kind: One of `KINDS`.
    """
    map_name = KINDS[kind][0]
    attribute_map = next(
        candidate
        for candidate in model.instances(bridge.AttributeMap)
        if candidate.name == map_name
    )
    entry = DefinedCatalogue(model).message(str(attribute_map.message.name))
    jaus = entry.encode({str(attribute_map.message.body.name): jaus_fields(kind)})
    type_ = attribute_map.type
    ros_class = message_class(f"{type_.eContainer().name}/{type_.name}")
    ros = serialize_message(ros_message(kind, ros_class))
    return Sample(kind, map_name, jaus, ros, ros_class)
