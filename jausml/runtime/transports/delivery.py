"""Messages as transports hand them over."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.loop import Loop
    from .packets.packet import Priority

MESSAGE_CODE_SIZE = 2
"""Bytes of the message code with which every payload begins."""


class ReceivedMessage(NamedTuple):
    """One JAUS message as it arrived.

    Attributes:
        payload: Little-endian 16-bit message code and body.
        sequence: Sequence number of its (first) packet.
    """

    source: JausAddress
    destination: JausAddress
    payload: bytes
    priority: Priority
    sequence: int


class Arrival:
    """The message that is being handed over.

    Attributes:
        number: Its sequence number, by which later ones of its source can be told from earlier
            ones; None where the transport keeps the order, and for what goes to a wildcard.
        is_sure: Whether it asks for acknowledgement; its repetition rightly comes late.
        origin: Where it came from, such as an endpoint; another process is heard from elsewhere.
    """

    __slots__ = ("is_sure", "number", "origin")

    def __init__(self) -> None:
        self.number: int | None = None
        self.is_sure = False
        self.origin: object = None


class PeerTraffic(NamedTuple):
    """What a component of this process and another one have exchanged so far.

    A message is one packet or, if it is large, several; acknowledgements are not counted. What the
    numbers of the peer tell (``Account``) is exact if it numbers what it sends by destination, as
    components of jausml do, or talks to this component alone. Else ``lost`` is an upper bound.

    Attributes:
        acknowledged_late: Messages that were acknowledged when they had been given up.
        answered: Messages whose answer came, and no acknowledgement.
        unacknowledged: Messages that never were, though they may have arrived.
        lost: Packets of the peer that were lost on the way.
        is_exact: Whether the peer is known not to number for all whom it talks to.
    """

    own: JausAddress
    peer: JausAddress
    sent: int = 0
    acknowledged: int = 0
    acknowledged_late: int = 0
    answered: int = 0
    unacknowledged: int = 0
    came: int = 0
    lost: int = 0
    late: int = 0
    repeated: int = 0
    restarts: int = 0
    is_exact: bool = False


class Double(NamedTuple):
    """Another component that was heard with the address of one of this process.

    Attributes:
        first_heard: When it was heard first, in UTC.
        last_heard: When it was heard last, by the clock of the loop.
    """

    address: JausAddress
    place: str
    first_heard: datetime
    last_heard: float

    def __str__(self) -> str:
        """Return what is wrong, for people."""
        since = f"{self.first_heard:%Y-%m-%d %H:%M:%S} UTC"
        return (
            f"another component has your id: {self.address} at {self.place} (first heard {since})"
        )


Receive = Callable[[ReceivedMessage], None]
"""Takes a message for one component; runs on the loop's thread and holds the loop's lock."""

Take = Callable[[bytes, "JausAddress"], None]
"""Takes the payload of a message for one component and who sent it, as ``Receive`` does."""

OnResult = Callable[[bool], None]
"""Told whether a message went out; runs on the loop's thread and holds the loop's lock."""


def report(loop: Loop, on_result: OnResult | None, *, success: bool) -> None:
    """Tell a result in the next round of the loop."""
    if on_result is not None:
        loop.call_soon(partial(on_result, success))
