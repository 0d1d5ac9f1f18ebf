"""The two systems of the scenario: J, by JAUS alone, and R, whose follower is a ROS node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from experiments.right_turn.systems import System, generate

from . import EXAMPLE

if TYPE_CHECKING:
    from pathlib import Path

_ALONE = EXAMPLE / "without_ros"
_OPERATOR = EXAMPLE / "src" / "operator_unit"

SYSTEMS = {
    "J": System("J", _ALONE / "without_ros.ros2jaus", (_OPERATOR, _ALONE / "src" / "robot")),
    "R": System("R", EXAMPLE / "waypoint_list.ros2jaus", (_OPERATOR,)),
}


def generated(name: str, folder: Path) -> Path:
    """Generates a system into a folder that is made anew, with the code of its users.

    Raises:
        RuntimeError: The model cannot be generated; says what jausml said.
    """
    shared = {"robot/robot/driving.py": EXAMPLE / "driving.py"} if name == "J" else {}
    generate(SYSTEMS[name], folder, shared)
    return folder
