"""Messages of Junior whose flags are all set, and therefore say nothing."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

from ...base.settings import MAX_FRAGMENT_SIZE
from .packet import AckNak, Broadcast, DataFlags, Packet, Priority

if TYPE_CHECKING:
    from ...base.address import JausAddress

_MAX_SOURCES = 256


# JAUS-DEVIATION: by AS5669A a packet with these flags is an acknowledgement. Junior sets all eight
# bits when its API is called with priority 0; what it means is a message of low priority.
class FlaglessMessages:
    """Tells whole messages from fragments among packets whose flags are all set.

    A message longer than Junior's packets comes as full packets and a shorter tail, and nothing
    marks them. A short packet is taken for a whole message, unless its source sent a full one
    lately: it may then be the tail. A tail is taken for a message when all that came before it
    was lost on the way; its body will hardly be one that its first two bytes call for.
    """

    def __init__(self, seconds: float) -> None:
        """Start with no sources in doubt.

        Args:
            seconds: How long a full packet casts doubt on the short ones of its source.
        """
        self._seconds = seconds
        self._fragmenting: OrderedDict[JausAddress, float] = OrderedDict()

    def whole(self, packet: Packet, now: float) -> Packet | None:
        """Return the message that a packet with a payload is, or None if it may be a fragment."""
        if (packet.priority, packet.broadcast, packet.acknowledge, packet.data_flags) != (
            Priority.SAFETY_CRITICAL,
            Broadcast.RESERVED,
            AckNak.ACK,
            DataFlags.LAST,
        ):
            return None
        source = packet.source
        if len(packet.payload) >= MAX_FRAGMENT_SIZE:
            self._fragmenting[source] = now
            self._fragmenting.move_to_end(source)
            if len(self._fragmenting) > _MAX_SOURCES:
                self._fragmenting.popitem(last=False)
            return None
        doubted = self._fragmenting.get(source)
        if doubted is not None and now - doubted < self._seconds:
            return None
        return packet._replace(
            priority=Priority.LOW,
            broadcast=Broadcast.NONE,
            acknowledge=AckNak.NONE,
            data_flags=DataFlags.SINGLE,
        )
