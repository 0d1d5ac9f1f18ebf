"""ROS as a bridge sees it, on rclpy or in virtual time: its node."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, TypeVar

from ...base.loop import Loop
from ...conversions import Time
from .topics import Parameter, Published, Topic, TopicCounts, TopicFault

PartT = TypeVar("PartT")


class RosPublisher(Protocol):
    """A publisher for serialized messages."""

    publish: Callable[[bytes], None]
    unmatched: int  # while no subscription was there; whoever publishes counts

    @property
    def matched(self) -> int:
        """How many subscriptions are connected."""

    @property
    def address(self) -> int:
        """Where the client library has it; 0 where there is no such library."""

    @property
    def published(self) -> Published:
        """What it was made for."""


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
        """Makes a publisher; each subscriber that is found is greeted on the loop."""

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Makes a subscription.

        Each serialized message is taken with the time of its publication, in nanoseconds by the
        clock of its publisher; on the loop or with its lock.
        """

    def part(self, load: Callable[[], Callable[[Any], PartT]]) -> PartT:
        """Returns a part of the node, made when it is first asked for, e.g. its services.

        Who asks imports its class on rclpy, so that a workspace has it only where something of the
        model asks; a virtual node has parts of its own.
        """

    def faults(self, topic: Topic, *, publishes: bool, alone: bool = False) -> Sequence[TopicFault]:
        """Returns why a topic does not work; a second publisher is a fault where one is alone."""

    def publish_diagnostics(self, data: bytes) -> None:
        """Publishes a serialized `diagnostic_msgs/msg/DiagnosticArray`."""


@dataclass
class Feed:
    """A subscription, as a core is told of it."""

    address: int  # where the client library has it
    descriptor: int  # the eventfd that says how many messages wait
    age_limit: int  # nanoseconds after which a message that waits is too old; 0 means never
    counts: TopicCounts
    expected: int = 0  # the number of the next message


class Other(NamedTuple):
    """A message that is not usual, which a core has taken."""

    data: bytes
    number: int | None  # that of its publisher; None where the middleware does not tell it
    received: int  # when, in nanoseconds since 1970, as when it was published
    published: int
    left: int  # how many more wait
