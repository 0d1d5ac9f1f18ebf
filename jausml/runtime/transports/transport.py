"""What components need of a transport; they know nothing else of it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, Protocol

from .packets.packet import Priority

if TYPE_CHECKING:
    from ..base.address import JausAddress
    from ..base.counters import Counters
    from ..base.loop import Loop

MESSAGE_CODE_SIZE = 2
"""Bytes of the message code with which every payload begins."""


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

OnResult = Callable[[bool], None]
"""Told whether a message went out; runs on the loop's thread and holds the loop's lock."""


def report(loop: Loop, on_result: OnResult | None, *, success: bool) -> None:
    """Tell a result in the next round of the loop.

    Args:
        loop: The loop.
        on_result: Who wants to know, if anybody.
        success: Whether the message went out.
    """
    if on_result is not None:
        loop.call_soon(partial(on_result, success))


class Transport(Protocol):
    """What components need to exchange messages.

    Implemented by ``judp.JudpTransport`` (UDP), ``jtcp.JtcpTransport`` (TCP) and
    ``node_manager.NodeManagerTransport`` (through the host's node manager).
    """

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
        on_result: OnResult | None = None,
    ) -> None:
        """Send one message; callable from any thread, sends on it, never blocks.

        Failures of the network are counted and reported to ``on_result``.

        Args:
            source: Component that sends, of this process.
            destination: Component, or a wildcard for several.
            payload: Little-endian 16-bit message code and body.
            priority: Priority of the message.
            acknowledge: Repeat until acknowledged; of several receivers one is enough.
            on_result: Told once whether the message was acknowledged or received in this
                process; without ``acknowledge``, whether it was put on the network.

        Raises:
            ValueError: The source is not one component or the payload has no message code.
        """
