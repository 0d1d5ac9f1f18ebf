"""Assignments of attribute maps as straight-line Python statements.

Text of the model enters the statements only as literals and as names that were found in the model's
types.
"""

from __future__ import annotations

from jausml.generators.bridge.translation.body import Body
from jausml.generators.bridge.translation.maps import (
    jaus_constants,
    ros_constants,
    to_jaus,
    to_ros,
    used_maps,
)
from jausml.generators.bridge.translation.surroundings import Surroundings
from jausml.generators.bridge.translation.values import AssignmentError, ros_constant, ros_kind

__all__ = [
    "AssignmentError",
    "Body",
    "Surroundings",
    "jaus_constants",
    "ros_constant",
    "ros_constants",
    "ros_kind",
    "to_jaus",
    "to_ros",
    "used_maps",
]
