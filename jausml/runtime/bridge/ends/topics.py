"""Topics, services and parameters of ROS as a bridge names them, without rclpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..light_message import LightMessage


@dataclass(frozen=True)
class Qos:
    """Quality of service in the words of ROS 2; the defaults are those of a plain publisher.

    Attributes:
        reliability: `reliable`, `best_effort` or `system_default`.
        durability: `volatile`, `transient_local` or `system_default`.
        history: `keep_last`, `keep_all` or `system_default`. A publisher keeps 5000 messages for
            `keep_all`: it must not wait for a reader that stands still.
        depth: Messages kept with `keep_last`.
        deadline: Longest expected time between messages in seconds; 0 means none.
        lifespan: Seconds after which a message is stale; 0 means never.
        liveliness: `automatic`, `manual_by_topic` or `system_default`.
        lease_duration: Seconds within which liveliness must be shown; 0 means none.
    """

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "keep_last"
    depth: int = 10
    deadline: float = 0.0
    lifespan: float = 0.0
    liveliness: str = "automatic"
    lease_duration: float = 0.0


@dataclass(frozen=True)
class Published:
    """What a publisher was made for."""

    topic: str
    type: str
    qos: Qos


@dataclass(slots=True)
class TopicCounts:
    """What happened to the messages of a subscription.

    Attributes:
        taken: Messages taken from its queue.
        lost: Messages that were overwritten in the queue, or whose lifespan ended there, before
            they were taken: the bridge was too slow. Only a listener tells them, no wait set.
        missed: Messages that were published and never taken, those of `lost` included. Publishers
            number their messages, but do not sign them: it is told only while there is one.
        too_old: Messages taken and dropped because they had waited too long.
    """

    taken: int = 0
    lost: int = 0
    missed: int = 0
    too_old: int = 0


@dataclass(frozen=True)
class Topic:
    """A topic of a connection.

    Attributes:
        name: Topic name; relative names are resolved in the namespace of the node.
        qos: Quality of service, which `qos_overrides` parameters may change.
    """

    name: str
    qos: Qos = Qos()


@dataclass(frozen=True)
class RosService:
    """A service of ROS.

    Attributes:
        type_name: Its type, e.g. `std_srvs/srv/SetBool`.
        success: Path of the bool of the response that tells whether all went well; may be empty.
        reason: Path of the text of the response that tells why not; may be empty.
    """

    name: str
    type_name: str
    request: type[LightMessage]
    response: type[LightMessage]
    success: str = ""
    reason: str = ""


class ServiceClient(Protocol):
    """Calls one service of ROS."""

    def is_ready(self) -> bool:
        """Whether somebody serves."""

    def call(self, request: bytes, answered: Callable[[bytes], None]) -> Callable[[], None]:
        """Calls the service.

        Args:
            answered: Is given the serialized response on the loop.

        Returns:
            What forgets the call.
        """


@dataclass(frozen=True)
class Parameter:
    """A parameter of the node.

    Attributes:
        limits: Least and greatest value of a number.
        check: Raises ValueError for a value that does not do; None takes all.
    """

    name: str
    default: Any
    description: str
    limits: tuple[float, float] | None = None
    check: Callable[[Any], object] | None = None
