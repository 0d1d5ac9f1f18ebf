"""Stops that a guardian sends in place of its bridge, and their progress."""

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
    stamps: list[int]  # offsets of the present time in `data`


@dataclass
class Datagram:
    """A stop for a JAUS component."""

    data: bytearray
    endpoint: tuple[str, int]
    slot: int  # index of its sequence number in the page


@dataclass
class Stops:
    """The stops of one connection."""

    patience: float  # seconds without a beat after which they are sent
    topics: list[Topic]
    datagrams: list[Datagram]
    refused: int  # topics that ROS has refused


@dataclass
class Announcement:
    """The publications of a stop on a topic."""

    publisher: Publisher
    topic: Topic
    rivals: int  # publishers of the topic when the stop was due, with this one
    times: dict[int, int] = field(default_factory=dict)  # by number of subscribers
    last: float = 0.0


@dataclass
class Cancellation:
    """The requests to cancel a goal."""

    canceller: Any
    goal: bytes
    service: str
    first: float = 0.0  # time of the first request; 0 before its server was found
    last: float = 0.0
