"""What must be refused, or the experiment proves nothing: R with one mistake each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from .drives import EMERGENCY, LOST, WHOLE
from .virtual import Conditions

if TYPE_CHECKING:
    from collections.abc import Callable

    from .drives import Drive

FOOT = 0.3048
"""Metres."""


@dataclass(frozen=True)
class Control:
    """A mistake.

    Attributes:
        about: What it is, in words.
        drive: What shows it.
    """

    about: str
    drive: Drive
    conditions: Conditions


def _elsewhere(change: Callable[[Any], None]) -> Callable[[Any], Any]:
    """Returns what makes a bridge that sends the robot elsewhere."""

    def broken(bridge: Any) -> Any:
        class Broken(bridge):  # type: ignore[misc] - known when it runs
            def translate_waypoints(self, source: Any) -> Any:
                target = super().translate_waypoints(source)
                change(target.pose.position)
                return target

        return Broken

    return broken


def _mirror(position: Any) -> None:
    position.y = -position.y


def _exchange(position: Any) -> None:
    position.x, position.y = position.y, position.x


def _shrink(position: Any) -> None:
    position.x, position.y = position.x * FOOT, position.y * FOOT


def _poses_of_a_map(bridge: Any) -> Any:
    """Makes a bridge that tells poses as if x of ROS were east and x of JAUS north."""

    class Broken(bridge):  # type: ignore[misc] - known when it runs
        def translate_pose(self, source: Any) -> Any:
            target = super().translate_pose(source)
            target.x, target.y = -target.y, target.x
            return target

    return Broken


def _trusting(bridge: Any) -> Any:
    """Makes a bridge that never takes its operator for lost."""

    class Broken(bridge):  # type: ignore[misc] - known when it runs
        def __init__(self) -> None:
            super().__init__()
            component = replace(self.settings.component, control_timeout=0)
            self.settings = replace(self.settings, component=component)

    return Broken


CONTROLS = {
    "sign": Control(
        "waypoints with y to the wrong side", WHOLE, Conditions(broken=_elsewhere(_mirror))
    ),
    "axes": Control(
        "waypoints with x and y exchanged", WHOLE, Conditions(broken=_elsewhere(_exchange))
    ),
    "unit": Control("waypoints taken for feet", WHOLE, Conditions(broken=_elsewhere(_shrink))),
    "frame": Control(
        "waypoints in the frame of a map",
        WHOLE,
        Conditions(parameters={"waypoints.frame_id": "map"}),
    ),
    "poses": Control("poses in the frame of a map", WHOLE, Conditions(broken=_poses_of_a_map)),
    "cancel": Control(
        "a follower that does not stop when its goal is canceled",
        EMERGENCY,
        Conditions(is_deaf=True),
    ),
    "stop": Control("no stop when the operator is lost", LOST, Conditions(broken=_trusting)),
}
"""Mistakes by their names."""

LATE = Conditions(late=0.1)
"""A drive that does all that is required, and whose path must be told from that of J."""
