"""Duplicate detection by source, sequence number and content."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from .packet import Packet


class DuplicateWindow:
    """Remembers the latest packets of each source (AS5669A, sequence numbers).

    A packet is a duplicate when its number came within ``seconds`` with the same content and is
    among the latest ``history`` of its source. The number alone does not tell: that of a component
    which restarts may begin anew, at 1 in each process of Junior, and what was acknowledged
    and then dropped is lost for good. At most ``sources`` sources are remembered; the one
    silent longest goes first.
    """

    def __init__(self, seconds: float = 1.5, history: int = 512, sources: int = 256) -> None:
        """Start with no packets seen."""
        self._seconds = seconds
        self._history = history
        self._sources = sources
        self._seen: OrderedDict[JausAddress, dict[int, tuple[float, int]]] = OrderedDict()

    def __len__(self) -> int:
        """Return how many packets are remembered."""
        return sum(map(len, self._seen.values()))

    def is_duplicate(self, packet: Packet, now: float) -> bool:
        """Return whether the packet was seen before, and remember it.

        Args:
            packet: The packet; numbers count per source, not per destination. Its flags may differ
                in a repetition.
            now: Time in seconds.
        """
        sequence = packet.sequence
        content = hash(packet.payload) ^ packet.destination.packed
        numbers = self._seen.get(packet.source)
        if numbers is None:
            if len(self._seen) >= self._sources:
                self._seen.popitem(last=False)
            self._seen[packet.source] = {sequence: (now, content)}
            return False
        self._seen.move_to_end(packet.source)
        before = numbers.get(sequence)
        if before is not None:
            if before[1] == content and now - before[0] < self._seconds:
                return True
            del numbers[sequence]
        elif len(numbers) >= self._history:
            del numbers[next(iter(numbers))]
        numbers[sequence] = (now, content)
        return False
