"""The two ends of a bridge: what a bridge sees of ROS, and connections of the bridge."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ...base.settings import TransportSettings
from ...component.base import COMPONENT_TYPE
from ...services.definitions import ComponentSettings, ServiceIdentity

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from contextlib import AbstractContextManager

    from ...base.address import JausAddress
    from ...base.clocks import Timing
    from ...base.fast_path import FastSending
    from ...base.loop import Loop
    from ...clients.exchanges import Exchanges
    from ...clients.peer_search import PeerBinding
    from ...component.component import JausComponent
    from ...conversions import Time
    from ...guardian.ward import Ward
    from ...services.definitions import Guard
    from ...wire import Message
    from ..messages.compiled import Compiled, Function
    from .actions import ActionClient, GoalTaker, ListAction
    from .by_sender import Taker
    from .list_driver import ListDriver, ListMessages
    from .simulation import Simulation
    from .topics import (
        Parameter,
        Published,
        RosService,
        ServiceClient,
        Topic,
        TopicCounts,
        TopicFault,
    )


@dataclass(frozen=True)
class BridgeSettings:
    """What the model says about a bridge, apart from its connections.

    Attributes:
        frequency: Messages each second where the model states no rate. Diagnostics come at this
            rate too, but not more often than once a second.
        services: Services that the bridge provides, inherited ones included.
        authority: Authority code that control is requested with, 0 to 255.
        guardian: Whether a small process beside the bridge says its stops when the bridge cannot.
    """

    name: str
    address: JausAddress
    description: str = ""
    namespace: str = ""
    frequency: float = 1.0
    services: tuple[ServiceIdentity, ...] = ()
    component_type: int = COMPONENT_TYPE
    authority: int = 127
    component: ComponentSettings = field(default_factory=ComponentSettings)
    transport: TransportSettings = field(default_factory=TransportSettings)
    guardian: bool = True


class RosPublisher(Protocol):
    """A publisher for serialized messages.

    Attributes:
        publish: Publishes a serialized message, from any thread.
        unmatched: Messages that found none of them; whoever publishes counts.
    """

    publish: Callable[[bytes], None]
    matched: int
    unmatched: int

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

    def faults(self, topic: Topic, *, publishes: bool) -> Sequence[TopicFault]:
        """Returns why a topic does not work as it should; nothing while it does."""

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


class Feeder(Protocol):
    """What feeds a report."""

    def judge_silence(self) -> None:
        """Withdraws what it has said if that is too old by now."""


@dataclass(slots=True)
class ReportHolder:
    """The present report that topics feed.

    Attributes:
        value: It, encoded; None before their first message.
        feeder: The connection that spoke last; None before.
    """

    value: bytes | None = None
    feeder: Feeder | None = None

    def present(self) -> bytes | None:
        """Returns the report that counts now.

        What is too old is withdrawn here too: after a halt of the process, whoever asks may come
        before the timer of the silence.
        """
        if self.feeder is not None:
            self.feeder.judge_silence()
        return self.value


class Feed(Protocol):
    """A subscription of the bridge."""

    counts: TopicCounts


class Ends(Protocol):
    """A bridge as its connections see it; `Bridge` is the one.

    Attributes:
        clock: The time by which messages are late: that of the loop, or of a simulation.
        ward: What tells the guardian; None where there is none.
    """

    settings: BridgeSettings
    exchanges: Exchanges
    clock: Timing
    simulation: Simulation | None
    ward: Ward | None
    ros: RosSide
    component: JausComponent

    @property
    def loop(self) -> Loop:
        """The loop of the JAUS side."""

    def compiled(self, compiled: Compiled, note: Callable[[str], None]) -> Function | None:
        """Returns the function of a translation; None where its library is not there.

        Args:
            note: Counts a field that is left out, as its value is no number.
        """

    def fast_translation(self, compiled: Compiled) -> Any:
        """Returns what a core is given to translate alone; None where Python has a part in it."""

    def fast_subscriber(self, feed: Any, path: FastSending) -> FastSubscriber | None:
        """Returns a core that takes the messages of a subscription; None where none can."""

    def at(self, moment: Time) -> AbstractContextManager[None]:
        """Lets translations take a moment for the present."""

    def publisher(
        self, message_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> RosPublisher:
        """Returns what publishes on a topic; `greet` is called for each subscriber found."""

    def subscribe(
        self, message_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> Feed:
        """Subscribes to a topic when all connections are open."""

    def accept(
        self,
        message: type[Message],
        taker: Taker,
        when: Guard | Callable[[Any], Guard],
    ) -> None:
        """Takes messages that other components send to the bridge."""

    def note_unasked(
        self,
        message: type[Message],
        note: Callable[[bytes, JausAddress], None],
        peers: PeerBinding,
    ) -> None:
        """Tells of reports of peers that nobody takes, as they are asked for in another way."""

    def report(self, query: type[Message], report: type[Message]) -> ReportHolder:
        """Offers a report."""

    def list_driver(self, messages: ListMessages) -> ListDriver:
        """Returns the list driver that the bridge provides."""
