"""Packetizer: from messages to numbered packets."""

from __future__ import annotations

import random
import threading
from typing import TYPE_CHECKING

from .packet import Broadcast, DataFlags, Packet

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from .packet import AckNak, Priority

_MAX_FRAGMENTS = 32768


class Packetizer:
    """Numbers the packets of each source and cuts large messages; callable from any thread."""

    def __init__(self, fragment_size: int) -> None:
        """Start with no numbers used.

        Args:
            fragment_size: Largest payload of one packet in bytes.
        """
        self._fragment_size = fragment_size
        self._sequences: dict[JausAddress, int] = {}
        self._lock = threading.Lock()

    def refusal(self, destination: JausAddress, size: int) -> str:
        """Return the counter of what forbids to send so many bytes, if anything does."""
        if destination.is_wildcard:
            # Peers do not reassemble broadcasts (Junior refuses to send them).
            return "transport.broadcast_too_large" if size > self._fragment_size else ""
        if not destination.is_concrete:
            return "transport.bad_destination"
        if size > self._fragment_size * _MAX_FRAGMENTS:
            return "transport.message_too_large"
        return ""

    def packets(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        priority: Priority,
        acknowledge: AckNak,
    ) -> list[Packet]:
        """Return the packets of a message with their sequence numbers."""
        step, none = self._fragment_size, Broadcast.NONE
        if len(payload) <= step:
            number = self.reserve(source, 1)
            return [Packet(destination, source, payload, number, priority, none, acknowledge)]
        parts = [payload[start : start + step] for start in range(0, len(payload), step)]
        flags = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (len(parts) - 2), DataFlags.LAST]
        first = self.reserve(source, len(parts))
        return [
            Packet(
                destination,
                source,
                part,
                first + index & 0xFFFF,
                priority,
                none,
                acknowledge,
                flag,
            )
            for index, (part, flag) in enumerate(zip(parts, flags, strict=True))
        ]

    def reserve(self, source: JausAddress, count: int) -> int:
        """Take consecutive sequence numbers of a source and return the first."""
        with self._lock:
            first = self._sequences.get(source)
            if first is None:
                # A restarted sender must not repeat numbers that peers remember as seen.
                first = random.randrange(0x10000)
            self._sequences[source] = first + count & 0xFFFF
        return first
