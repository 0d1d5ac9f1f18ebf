"""What parameters of ROS nodes mean for a model, by the names that packages give them.

Nothing is filled in by what they say but names: limits and times decide what is safe, and what a
node is told to do need not be what the vehicle can do.
"""

from __future__ import annotations

import re
from typing import Any

_ROLES = {
    "odom": ("odom_frame", "odom_frame_id"),
    "base_link": ("base_frame", "base_frame_id", "base_link_frame", "robot_base_frame"),
    "map": ("map_frame", "map_frame_id"),
}
"""Frames of REP 105, and how parameters are called that name those of a robot."""

_MEANINGS = (
    (r"use_sim_time", "the bridge needs use_sim_time: true too"),
    (r"(\w+_)?frame(_id)?", "the name of a frame"),
    (
        r"(\w*_)?(cmd_vel|command|cmd|watchdog)_timeout",
        "what takes commands stops by itself after that many seconds; silenceTimeout of the "
        "connection is yours to decide",
    ),
    (
        r"(max|min)_(vel|velocity|speed|accel|acceleration|steering|angular|linear)\w*"
        r"|\w*(vel|speed|acc)_(max|min)",
        "a limit of what it obeys; that of the vehicle is yours to state, as a quantity of the "
        "bridge where a map has one",
    ),
    (
        r"(publish|update|control|controller|odom)?_?(rate|frequency)",
        "messages a second; the rate of a connection is what JAUS is sent, as much by default",
    ),
    (
        r"wheel_(separation|radius|base|track)|wheelbase|track_width",
        "geometry, of which no message of the library tells",
    ),
)
"""Patterns of the last part of a name, and what a model makes of such a parameter."""

_DESCRIPTION = "robot_description"

_JOINT, _ATTRIBUTE = (
    re.compile(r"<joint\b([^<>]*)>"),
    re.compile(r"""(\w+)\s*=\s*["']([^"']*)["']"""),
)
_MOVABLE = frozenset({"revolute", "continuous", "prismatic"})


def is_worth_reading(name: str) -> bool:
    """Tells by the name of a parameter whether it says anything for a model."""
    return name == _DESCRIPTION or bool(_meaning(name))


def says(name: str, value: Any) -> str:
    """Returns what a parameter means for a model; empty for one that means nothing as it is."""
    if name == _DESCRIPTION:
        found = ",".join(described_joints(value))
        return f"movable joints {found}; --joints TOPIC={found} states them" if found else ""
    if value in (False, "", None):
        return ""
    return _meaning(name)


def frame_role(name: str) -> str:
    """Returns which frame of REP 105 a parameter names; empty for none."""
    last = name.rpartition(".")[2]
    return next((role for role, names in _ROLES.items() if last in names), "")


def described_joints(description: Any) -> list[str]:
    """Returns the joints of a URDF that move, in its order."""
    found = (dict(_ATTRIBUTE.findall(each)) for each in _JOINT.findall(str(description)))
    return [each["name"] for each in found if each.get("type") in _MOVABLE and "name" in each]


def _meaning(name: str) -> str:
    last = name.rpartition(".")[2]
    return next((text for pattern, text in _MEANINGS if re.fullmatch(pattern, last)), "")
