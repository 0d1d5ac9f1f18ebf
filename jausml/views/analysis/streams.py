"""Streams: messages of one kind from one component to another, as often as they flow."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.language.semantics.commands import needs_control
from jausml.views.analysis.constants import runtime_constants
from jausml.views.analysis.datagrams import Wire, acknowledgements, on_wire, packet_count

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge, jaus
    from jausml.views.analysis.sizes import Size

    Asking = bridge.Connection | jaus.ServiceConnection

DECLARED, ASSUMED = "declared", "assumed"
"""Where a rate is from: the model, or an assumption."""


@dataclass(eq=False)
class Stream:
    """Messages of one kind from one component to another.

    Attributes:
        sender: Who sends; None for whoever it is.
        receiver: Who receives; None for whoever it is.
        kind: `message`, `event`, `query`, `report` or `upkeep`.
        size: Bytes of the message with its code, that of an event with its header.
    """

    sender: jaus.Component | None
    receiver: jaus.Component | None
    message: str
    kind: str
    size: Size
    hertz: float
    basis: str
    fragment_size: int
    wants_acknowledgement: bool = False
    connections: list[Asking] = field(default_factory=list)

    @property
    def packets(self) -> int:
        """Packets of an expected message."""
        return packet_count(self.size.expected, self.fragment_size)

    @property
    def is_acknowledged(self) -> bool:
        """Whether its packets are acknowledged; those of a message of many are in any case."""
        return self.wants_acknowledgement or self.packets > runtime_constants().at_once

    @property
    def forth(self) -> Wire:
        """What it is on the network each second."""
        return on_wire(self.size.expected, self.fragment_size).times(self.hertz)

    @property
    def back(self) -> Wire:
        """What its acknowledgements are on the network each second."""
        return acknowledgements(self.packets * self.hertz if self.is_acknowledged else 0)


@dataclass(frozen=True)
class Traffic:
    """All streams of a system."""

    streams: tuple[Stream, ...]
    by_connection: dict[Asking, list[Stream]]

    def of(self, connection: Asking) -> list[Stream]:
        """Returns the streams of a connection."""
        return self.by_connection.get(connection, [])


def is_to_ros(connection: bridge.Connection) -> bool:
    """Tells whether a connection publishes."""
    return bool(connection.direction.name == "jausToRos")


def is_single(connection: bridge.Connection) -> bool:
    """Tells whether a connection takes or sends each message by itself."""
    return bool(connection.exchange.name == "message")


def keeps_control(connection: bridge.Connection) -> bool:
    """Tells whether a connection makes its bridge keep control of its peers."""
    if is_to_ros(connection) or not is_single(connection) or not connection.control:
        return False
    service = connection.map.message.eContainer()
    return service is not None and needs_control(connection.map.message, service)
