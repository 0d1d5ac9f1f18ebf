"""The two ends of a bridge: what a bridge sees of ROS, and connections of the bridge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.address import JausAddress
    from ..base.loop import Loop
    from ..component.component import JausComponent
    from ..conversions import Time
    from ..services.definitions import Guard
    from ..wire import Message
    from .diagnostics import ConnectionStatus
    from .parameter import Parameter
    from .quality import TopicFault
    from .settings import BridgeSettings
    from .topics import Topic


class RosSide(Protocol):
    """All that a bridge sees of ROS; `RosNode` in ros.py is the one on rclpy.

    Messages are objects of the message classes. A side that carries serialized messages instead
    differs from this in what `message_type` and the arguments of `deliver` and of the publishing
    function stand for.
    """

    def now(self) -> Time:
        """Time of the ROS clock."""

    def parameter(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value; `changed` takes each later one."""

    def publisher(
        self, message_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> Callable[[Any], None]:
        """Makes a publisher and returns what publishes on it, callable from any thread.

        Args:
            message_type: Class of the messages.
            topic: The topic.
            greet: Called for each subscriber that is found, on the thread that waits.
        """

    def subscribe(
        self, message_type: type[Any], topic: Topic, deliver: Callable[[Any], None]
    ) -> None:
        """Makes a subscription; `deliver` runs on the thread that waits for ROS messages."""

    def faults(self, topic: Topic, *, publishes: bool) -> Sequence[TopicFault]:
        """Returns why a topic does not work as it should; nothing while it does."""

    def publish_diagnostics(self, statuses: Sequence[ConnectionStatus]) -> None:
        """Publishes one status for each connection."""


@dataclass
class ReportHolder:
    """The present value of a report that topics feed; None before their first message."""

    value: Message | None = None


class Ends(Protocol):
    """A bridge as its connections see it; `Bridge` is the one.

    Attributes:
        settings: What the model says.
        component: The JAUS side.
        ros: The ROS side.
    """

    settings: BridgeSettings
    ros: RosSide
    component: JausComponent

    @property
    def loop(self) -> Loop:
        """The loop of the JAUS side."""

    def publisher(
        self, message_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> Callable[[Any], None]:
        """Returns what publishes on a topic; `greet` is called for each subscriber found."""

    def subscribe(self, message_type: type[Any], topic: Topic, take: Callable[[Any], None]) -> None:
        """Subscribes to a topic."""

    def accept(
        self,
        message: type[Message],
        take: Callable[[Any, JausAddress], None],
        when: Guard | Callable[[Any], Guard],
    ) -> None:
        """Takes messages that other components send to the bridge."""

    def report(self, query: type[Message], report: type[Message]) -> ReportHolder:
        """Offers a report."""
