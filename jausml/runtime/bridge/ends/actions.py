"""Interfaces of ROS actions for a bridge; rclpy and the virtual ROS implement them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from .topics import TopicFault

LONGEST_GOAL = 1024  # elements of a goal, as many as the list of a component takes by default


class Progress(Enum):
    """Meaning of the number in the feedback of an action."""

    INDEX = "index"  # which element is under way, from 0
    REMAINING = "remaining"  # how many elements remain, with the one that is under way

    # Metres that remain along the elements. Only clients may use it: they compute the index.
    DISTANCE = "distance"

    def index(self, number: int, count: int) -> int:
        """Returns the index of the element under way for a number, limited to 0 to `count` - 1."""
        position = count - number if self is Progress.REMAINING else number
        return min(max(position, 0), count - 1)

    def number(self, index: int, count: int) -> int:
        """Returns the number for the feedback while the element of an index is under way."""
        return count - index if self is Progress.REMAINING else index


class Outcome(Enum):
    """How a goal ended; logs and diagnostics show the value."""

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
    counting: Progress = Progress.INDEX  # meaning of that number
    # Path of the string of the result that says why the list was not done; empty for none.
    reason: str = ""


class SentGoal(Protocol):
    """A goal that the bridge has sent."""

    def cancel(self) -> None:
        """Requests its cancellation, now or when it is accepted; may be repeated."""

    def check(self) -> None:
        """Ends the goal as lost if its action server has gone."""

    def forget(self) -> None:
        """Calls its watcher no more; the goal is cancelled if it is accepted later."""


class GoalWatcher(Protocol):
    """Callbacks for a goal that the bridge has sent: on the loop, with its lock."""

    def accepted(self, goal: SentGoal) -> None:
        """The action server executes the goal."""

    def progressed(self, goal: SentGoal, number: int) -> None:
        """Feedback has come, with the number of its progress."""

    def ended(self, goal: SentGoal, outcome: Outcome, reason: str) -> None:
        """The goal has ended; this is the last call."""


class ActionClient(Protocol):
    """Sends goals of one action."""

    def send(
        self, elements: Sequence[bytes], fill: Callable[[Any], object] | None, watcher: GoalWatcher
    ) -> SentGoal:
        """Sends a goal with encoded elements; `fill` sets its other fields, on the loop."""

    def faults(self) -> Sequence[TopicFault]:
        """Returns why goals cannot be sent; nothing while they can."""


class ServedGoal(Protocol):
    """A goal that a ROS client has sent to the bridge."""

    request: Any

    def progress(self, number: int) -> None:
        """Publishes feedback."""

    def end(self, outcome: Outcome, reason: str = "") -> None:
        """Sends the result: succeeded, aborted or, if its client asked for that, canceled."""


class GoalTaker(Protocol):
    """Executes the goals of ROS clients; called with the lock of the loop."""

    def accepts(self, elements: Sequence[bytes], request: Any) -> bool:
        """Returns whether a goal can be executed; if so, `begin` is called next.

        Goals of more than `LONGEST_GOAL` elements are cut to one element more.
        """

    def begin(self, goal: ServedGoal) -> None:
        """Executes the goal that was accepted last."""

    def cancel(self, goal: ServedGoal) -> None:
        """Ends a goal, as its client asks."""
