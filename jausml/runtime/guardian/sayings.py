"""What a guardian may have to say in the place of its bridge, and how far it has said it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .rcl import Publisher


@dataclass
class Topic:
    """A stop for a topic."""

    name: str
    support: Any
    qos: dict[str, Any]
    data: bytearray
    stamps: list[int]  # where the present time stands in it


@dataclass
class Datagram:
    """A stop for a JAUS component."""

    data: bytearray
    endpoint: tuple[str, int]
    slot: int  # where the page has the sequence number


@dataclass
class Stops:
    """What ends what a connection has set in motion."""

    patience: float  # seconds without a beat after which it is said
    topics: list[Topic]
    datagrams: list[Datagram]
    refused: int


@dataclass
class Told:
    """How often whoever listens to a stop was told, by the number of those who do."""

    publisher: Publisher
    topic: Topic
    rivals: int  # publishers on the topic when the stop was due
    times: dict[int, int] = field(default_factory=dict)
    last: float = 0.0


@dataclass
class Cancel:
    """What was asked of the server of an action."""

    canceller: Any
    goal: bytes
    service: str
    first: float = 0.0  # when it was asked first, 0 before its server was found
    last: float = 0.0
