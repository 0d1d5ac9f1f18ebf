"""The interface of a ROS node for a bridge; rclpy and the virtual ROS implement it."""

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
    unmatched: int  # messages published without a subscription; counted by the caller of `publish`

    @property
    def matched(self) -> int:
        """Number of connected subscriptions."""

    @property
    def address(self) -> int:
        """Address of the publisher in rcl, for the core; 0 without rcl."""

    @property
    def published(self) -> Published:
        """Topic, type and QoS."""


class RosCodec(Protocol):
    """Serializes and deserializes messages of one class of rclpy."""

    def decode(self, data: bytes) -> Any:
        """Returns the object of a serialized message; raises DecodeError."""

    def encode(self, message: Any) -> bytes:
        """Returns an object, serialized; raises EncodeError."""


class RosSide(Protocol):
    """The node of a bridge; `RosNode` in `bridge/ros/node.py` is the one on rclpy.

    Messages are serialized (CDR with its encapsulation header). A ROS type is a class of rclpy, or
    a light class with a `TYPE` such as `nav_msgs/msg/Odometry`.
    """

    @property
    def name(self) -> str:
        """Full name of the node, e.g. `/fleet/bridge`."""

    def attach(self, loop: Loop) -> None:
        """Sets the loop of callbacks; to be called before the first publisher or subscription."""

    @property
    def is_simulated(self) -> bool:
        """Whether the ROS clock follows `/clock`."""

    def now(self) -> Time:
        """Returns the time of the ROS clock."""

    def follow_clock(self, take: Callable[[float], None]) -> None:
        """Calls `take` with each time on `/clock` in seconds, on the loop or with its lock."""

    def parameter(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value; `changed` is called with each later value."""

    def check_parameters(self) -> None:
        """Raises ParameterError, with a line for each value that was rejected so far."""

    def codec(self, ros_type: type[Any]) -> RosCodec:
        """Returns the codec for objects of rclpy."""

    def publisher(
        self, ros_type: type[Any], topic: Topic, on_match: Callable[[], None] | None = None
    ) -> RosPublisher:
        """Makes a publisher; `on_match` is called on the loop for each subscriber that is found."""

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Makes a subscription, and returns its counts.

        `take` is called on the loop, or with its lock, with each serialized message and the time of
        its publication in nanoseconds by the clock of its publisher.
        """

    def part(self, load: Callable[[], Callable[[Any], PartT]]) -> PartT:
        """Returns a part of the node, e.g. its services; the first call makes it.

        `load` imports the class of the part, so that a bridge without such connections does not
        need the module. A virtual node has its own class in place of it.
        """

    def faults(self, topic: Topic, *, publishes: bool, alone: bool = False) -> Sequence[TopicFault]:
        """Returns the faults of a topic; where `alone`, a second publisher is one."""

    def publish_diagnostics(self, data: bytes) -> None:
        """Publishes a serialized `diagnostic_msgs/msg/DiagnosticArray`."""


@dataclass
class Feed:
    """A subscription, for the core."""

    address: int  # of the subscription in rcl
    descriptor: int  # the eventfd that counts the waiting messages
    age_limit: int  # nanoseconds after which a message that waits is too old; 0 means never
    counts: TopicCounts
    expected: int = 0  # the number of the next message


class ReturnedMessage(NamedTuple):
    """A message that the core has taken and leaves to Python."""

    data: bytes
    number: int | None  # given by its publisher; None where the middleware does not support it
    received: int  # nanoseconds since 1970
    published: int  # nanoseconds since 1970
    left: int  # number of messages that still wait
