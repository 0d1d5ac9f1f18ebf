"""JAUS over UDP (AS5669A, JUDP version 2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol

from .packet import Priority

if TYPE_CHECKING:
    from .address import JausAddress
    from .counters import Counters
    from .loop import Loop


class ReceivedMessage(NamedTuple):
    """One JAUS message as it arrived.

    Attributes:
        source: Component that sent it.
        destination: Component or wildcard that it was sent to.
        payload: Little-endian 16-bit message code and body.
        priority: Priority that the sender chose.
        sequence: Sequence number of its (first) packet.
    """

    source: JausAddress
    destination: JausAddress
    payload: bytes
    priority: Priority
    sequence: int


Receive = Callable[[ReceivedMessage], None]
"""Takes a message for one component; runs on the loop's thread and holds the loop's lock."""


class Transport(Protocol):
    """What components need to exchange messages; ``JudpTransport`` is the one over UDP."""

    @property
    def loop(self) -> Loop:
        """The loop on which messages are received."""

    @property
    def counters(self) -> Counters:
        """Where drops are counted."""

    def attach(self, address: JausAddress, receive: Receive) -> None:
        """Receive messages for a component of this process from now on."""

    def detach(self, address: JausAddress) -> None:
        """Stop to receive messages for a component; no effect when it is unknown."""

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        on_result: Callable[[bool], None] | None = None,
    ) -> None:
        """Send one message; callable from any thread, never blocks."""
