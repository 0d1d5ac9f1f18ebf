"""Which way a connection of a bridge carries what it has, and a test vector tries a map."""

from __future__ import annotations

from typing import TypeAlias

from jausml.language.metamodel.classes import bridge

TO_ROS, TO_JAUS = "jausToRos", "rosToJaus"
"""Literals of `bridge.Direction`."""

Directed: TypeAlias = (
    "bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection"
    " | bridge.TestVector"
)


def is_to_ros(directed: Directed) -> bool:
    """Tells whether it leads from JAUS to ROS; a call or goal does where JAUS asks for it."""
    return bool(directed.direction.name == TO_ROS)
