"""What a guardian may have to say in the place of its bridge, and how far it has said it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .rcl import Publisher


@dataclass
class Topic:
    """A stop for a topic.

    Attributes:
        stamps: Where the present time stands in it.
    """

    name: str
    support: Any
    qos: dict[str, Any]
    data: bytearray
    stamps: list[int]


@dataclass
class Datagram:
    """A stop for a JAUS component.

    Attributes:
        slot: Where the page has the sequence number.
    """

    data: bytearray
    endpoint: tuple[str, int]
    slot: int


@dataclass
class Stops:
    """What ends what a connection has set in motion.

    Attributes:
        patience: Seconds without a beat after which it is said.
        refused: Topics that ROS refuses.
    """

    patience: float
    topics: list[Topic]
    datagrams: list[Datagram]
    refused: int


@dataclass
class Told:
    """How often whoever listens to a stop was told, by the number of those who do.

    Attributes:
        rivals: Publishers on the topic when the stop was due.
    """

    publisher: Publisher
    topic: Topic
    rivals: int
    times: dict[int, int] = field(default_factory=dict)
    last: float = 0.0


@dataclass
class Cancel:
    """What was asked of the server of an action.

    Attributes:
        first: When it was asked first, 0 before its server was found.
    """

    canceller: Any
    goal: bytes
    service: str
    first: float = 0.0
    last: float = 0.0
