"""Packetizer: from messages to numbered packets."""

from __future__ import annotations

import random
import threading
from typing import TYPE_CHECKING

from ...base.settings import MAX_FRAGMENT_SIZE
from .packet import Broadcast, DataFlags, Packet

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from .packet import AckNak, Priority

_MAX_FRAGMENTS = 32768
_MOST_SMALL_FRAGMENTS = 40


class Packetizer:
    """Numbers the packets of each source and cuts large messages; callable from any thread.

    Packets are larger than wished for where a message would take more than 40 of them, since
    Junior and the JAUS Tool Set hold no more than 50 of an unfinished message.
    """

    def __init__(self, fragment_size: int) -> None:
        """Start with no numbers used.

        Args:
            fragment_size: Payload of one packet in bytes that is not to be exceeded without need.
        """
        self._fragment_size = fragment_size
        self._sequences: dict[JausAddress, int] = {}
        self._lock = threading.Lock()

    def refusal(self, destination: JausAddress, size: int) -> str:
        """Return the counter of what forbids to send so many bytes, if anything does."""
        if destination.is_wildcard:
            # Peers do not reassemble broadcasts (Junior refuses to send them).
            return "transport.broadcast_too_large" if size > MAX_FRAGMENT_SIZE else ""
        if not destination.is_concrete:
            return "transport.bad_destination"
        if size > MAX_FRAGMENT_SIZE * _MAX_FRAGMENTS:
            return "transport.message_too_large"
        return ""

    def count(self, destination: JausAddress, size: int) -> int:
        """Return how many packets a message of so many bytes takes."""
        if size <= self._fragment_size:
            return 1
        return -(-size // self._step(destination, size))

    def packets(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        priority: Priority,
        acknowledge: AckNak,
    ) -> list[Packet]:
        """Return the packets of a message with their sequence numbers."""
        step, none = self._step(destination, len(payload)), Broadcast.NONE
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

    def _step(self, destination: JausAddress, size: int) -> int:
        if size <= self._fragment_size:
            return self._fragment_size
        if destination.is_wildcard:
            return MAX_FRAGMENT_SIZE
        needed = -(-size // _MOST_SMALL_FRAGMENTS)
        return max(self._fragment_size, min(MAX_FRAGMENT_SIZE, needed))

    def reserve(self, source: JausAddress, count: int) -> int:
        """Take consecutive sequence numbers of a source and return the first."""
        with self._lock:
            first = self._sequences.get(source)
            if first is None:
                # A restarted sender must not repeat numbers that peers remember as seen.
                first = random.randrange(0x10000)
            self._sequences[source] = first + count & 0xFFFF
        return first
