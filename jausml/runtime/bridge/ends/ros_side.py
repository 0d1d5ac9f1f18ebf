"""ROS as a bridge sees it, on rclpy or in virtual time: its node, and actions."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...base.loop import Loop
    from ...conversions import Time
    from .topics import (
        Parameter,
        Published,
        RosService,
        ServiceClient,
        Topic,
        TopicCounts,
        TopicFault,
    )


class RosPublisher(Protocol):
    """A publisher for serialized messages.

    Attributes:
        publish: Publishes a serialized message, from any thread.
        unmatched: Messages published while no subscription was there; whoever publishes counts.
    """

    publish: Callable[[bytes], None]
    unmatched: int

    @property
    def matched(self) -> int:
        """How many subscriptions are connected."""

    @property
    def address(self) -> int:
        """Where the client library has it; 0 where there is no such library."""

    @property
    def published(self) -> Published:
        """What it was made for."""

    def publish_message(self, message: Any) -> None:
        """Publishes an object of the class of rclpy, from any thread."""


class RosCodec(Protocol):
    """Messages of one class of rclpy, as objects and serialized."""

    def decode(self, data: bytes) -> Any:
        """Returns the object of a serialized message."""

    def encode(self, message: Any) -> bytes:
        """Returns the serialized form of an object."""


class RosSide(Protocol):
    """All that a bridge sees of ROS; `RosNode` in ros.py is the one on rclpy.

    Messages are serialized (CDR, with the header that names the encoding). A ROS type is a class
    of rclpy, or a light class, whose `TYPE` names it, e.g. `nav_msgs/msg/Odometry`.
    """

    @property
    def name(self) -> str:
        """Full name of the node, e.g. `/fleet/bridge`."""

    def attach(self, loop: Loop) -> None:
        """Tells which loop waits; to be called before there are publishers and subscriptions."""

    @property
    def is_simulated(self) -> bool:
        """Whether the ROS clock follows `/clock`."""

    def now(self) -> Time:
        """Time of the ROS clock."""

    def follow_clock(self, take: Callable[[float], None]) -> None:
        """Gives each time on `/clock` in seconds to a function, on the loop or with its lock."""

    def parameter(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value; `changed` takes each later one."""

    def check_parameters(self) -> None:
        """Raises ParameterError, with a line for each value so far that does not do."""

    def codec(self, ros_type: type[Any]) -> RosCodec:
        """Returns what makes objects of rclpy of serialized messages, and the reverse."""

    def publisher(
        self, ros_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> RosPublisher:
        """Makes a publisher.

        Args:
            greet: Called for each subscriber that is found, on the loop or with its lock.
        """

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Makes a subscription.

        Args:
            take: Is given each serialized message, and the time at which it was published, in
                nanoseconds by the clock of its publisher; on the loop or with its lock.
        """

    def action_client(self, action: ListAction) -> ActionClient:
        """Makes what sends goals of an action."""

    def serve(
        self, service: RosService, take: Callable[[bytes, Callable[[bytes], None]], None]
    ) -> None:
        """Serves a service.

        Args:
            take: Is given each serialized request and what replies to it, on the loop.
        """

    def serve_action(self, action: ListAction, taker: GoalTaker) -> None:
        """Takes the goals of an action."""

    def service_client(self, service: RosService) -> ServiceClient:
        """Returns what calls a service."""

    def faults(self, topic: Topic, *, publishes: bool, alone: bool = False) -> Sequence[TopicFault]:
        """Returns why a topic does not work as it should; nothing while it does.

        Args:
            alone: Whether a second publisher is a fault.
        """

    def publish_diagnostics(self, data: bytes) -> None:
        """Publishes a serialized `diagnostic_msgs/msg/DiagnosticArray`."""


class FastSubscriber(Protocol):
    """A core that takes the messages of a subscription and sends what they become.

    Attributes:
        is_current: Whether it still does.
    """

    is_current: bool

    def pending(self) -> Other | None:
        """Returns a message that is not usual, which was taken; None when there is none."""

    def look(self) -> None:
        """Tells the core what Python has learnt when it took a message."""


class Other(NamedTuple):
    """A message that is not usual, which a core has taken.

    Attributes:
        number: That of its publisher; None where the middleware does not tell it.
        received: When, in nanoseconds since 1970, as when it was published.
        left: How many more wait.
    """

    data: bytes
    number: int | None
    received: int
    published: int
    left: int


LONGEST_GOAL = 1024
"""Elements that one goal may have: as many as the list of a component takes by default."""


class Progress(Enum):
    """What a number in the feedback says of the list."""

    INDEX = "index"
    """Which element is under way, from 0."""

    REMAINING = "remaining"
    """How many elements remain, with the one that is under way."""

    DISTANCE = "distance"
    """How many metres remain along the elements; whoever reads the feedback makes an index of it,
    so nobody but the client of an action may have it."""

    def index(self, number: int, count: int) -> int:
        """Returns which of some elements is under way, from 0; the nearest for a number beyond."""
        position = count - number if self is Progress.REMAINING else number
        return min(max(position, 0), count - 1)

    def number(self, index: int, count: int) -> int:
        """Returns what the feedback says while an element is under way.

        Args:
            index: The element, from 0.
        """
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
    """A ROS action whose goal is a list.

    Attributes:
        type_name: Its type, e.g. `nav2_msgs/action/FollowWaypoints`.
        goal: Path of the array of the goal that has the elements.
        progress: Path of the number of the feedback that says how far the list is done; empty for
            none.
        counting: What that number says.
        reason: Path of the string of the result that says why the list was not done; empty for
            none.
    """

    type_name: str
    name: str
    element: type[Any]
    goal: str
    progress: str = ""
    counting: Progress = Progress.INDEX
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
        self,
        elements: Sequence[bytes],
        fill: Callable[[Any], object] | None,
        watcher: GoalWatcher,
    ) -> SentGoal:
        """Sends a goal.

        Args:
            fill: Sets what else the goal has; called with the goal of rclpy and the lock of the
                loop.
        """

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

        Args:
            elements: Its elements, serialized; one more than `LONGEST_GOAL` of a longer goal.
        """

    def begin(self, goal: ServedGoal) -> None:
        """Executes the goal that was accepted last."""

    def cancel(self, goal: ServedGoal) -> None:
        """Ends a goal, as its client asks."""
