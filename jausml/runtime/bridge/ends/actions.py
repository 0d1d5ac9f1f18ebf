"""Actions of ROS as a bridge sees them, on rclpy or in virtual time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from .topics import TopicFault

LONGEST_GOAL = 1024
"""Elements that one goal may have: as many as the list of a component takes by default."""


class Progress(Enum):
    """What a number in the feedback says of the list."""

    INDEX = "index"  # which element is under way, from 0
    REMAINING = "remaining"  # how many elements remain, with the one that is under way

    DISTANCE = "distance"
    """How many metres remain along the elements; whoever reads the feedback makes an index of it,
    so nobody but the client of an action may have it."""

    def index(self, number: int, count: int) -> int:
        """Returns which of some elements is under way, from 0; the nearest for a number beyond."""
        position = count - number if self is Progress.REMAINING else number
        return min(max(position, 0), count - 1)

    def number(self, index: int, count: int) -> int:
        """Returns what the feedback says while an element is under way, the first of which is 0."""
        return count - index if self is Progress.REMAINING else index


class Outcome(Enum):
    """How a goal ended; the value is what logs and diagnostics say."""

    SUCCEEDED = "succeeded"
    ABORTED = "aborted"
    CANCELED = "canceled"
    REFUSED = "refused"
    LOST = "lost"


@dataclass(frozen=True)
class ListAction:
    """A ROS action whose goal is a list."""

    type_name: str  # its type, e.g. `nav2_msgs/action/FollowWaypoints`
    name: str
    element: type[Any]
    goal: str  # path of the array of the goal that has the elements
    # Path of the number of the feedback that says how far the list is done; empty for none.
    progress: str = ""
    counting: Progress = Progress.INDEX  # what that number says
    # Path of the string of the result that says why the list was not done; empty for none.
    reason: str = ""


class SentGoal(Protocol):
    """A goal that the bridge has sent."""

    def cancel(self) -> None:
        """Asks that it ends; also when it is accepted later. May be repeated."""

    def check(self) -> None:
        """Finds out whether whoever executes it is still there."""

    def forget(self) -> None:
        """Tells nothing of it any more; if it is accepted later, it is cancelled."""


class GoalWatcher(Protocol):
    """Whoever is told of a goal that the bridge has sent: on the loop, with its lock."""

    def accepted(self, goal: SentGoal) -> None:
        """The action server executes it."""

    def progressed(self, goal: SentGoal, number: int) -> None:
        """The feedback says how far it is."""

    def ended(self, goal: SentGoal, outcome: Outcome, reason: str) -> None:
        """It has ended; nothing more comes of it."""


class ActionClient(Protocol):
    """Sends goals of one action."""

    def send(
        self, elements: Sequence[bytes], fill: Callable[[Any], object] | None, watcher: GoalWatcher
    ) -> SentGoal:
        """Sends a goal; `fill` sets what else it has, of rclpy and with the lock of the loop."""

    def faults(self) -> Sequence[TopicFault]:
        """Returns why goals cannot be sent; nothing while they can."""


class ServedGoal(Protocol):
    """A goal that a ROS client has sent to the bridge."""

    request: Any

    def progress(self, number: int) -> None:
        """Publishes feedback."""

    def end(self, outcome: Outcome, reason: str = "") -> None:
        """Gives the result: succeeded, aborted or, if its client asked for that, canceled."""


class GoalTaker(Protocol):
    """Whoever executes the goals of ROS clients; called with the lock of the loop."""

    def accepts(self, elements: Sequence[bytes], request: Any) -> bool:
        """Whether a goal can be executed now; `begin` comes at once if so.

        Of a longer goal there is one element more than `LONGEST_GOAL`.
        """

    def begin(self, goal: ServedGoal) -> None:
        """Executes the goal that was accepted last."""

    def cancel(self, goal: ServedGoal) -> None:
        """Ends a goal, as its client asks."""
