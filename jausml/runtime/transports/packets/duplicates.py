"""Duplicate detection by source and sequence number."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...base.address import JausAddress


class DuplicateWindow:
    """Remembers the latest sequence numbers of each source (AS5669A, sequence numbers).

    A number is a duplicate when it came within ``seconds`` and is among the latest ``history``
    of its source. At most ``sources`` sources are remembered; the one silent longest goes first.
    """

    def __init__(self, seconds: float = 3.0, history: int = 512, sources: int = 256) -> None:
        """Start with no numbers seen."""
        self._seconds = seconds
        self._history = history
        self._sources = sources
        self._seen: OrderedDict[JausAddress, dict[int, float]] = OrderedDict()

    def __len__(self) -> int:
        """Return how many numbers are remembered."""
        return sum(map(len, self._seen.values()))

    def is_duplicate(self, source: JausAddress, sequence: int, now: float) -> bool:
        """Return whether the packet was seen before, and remember it.

        Args:
            source: Sender of the packet; numbers count per source, not per destination.
            sequence: Number of the packet.
            now: Time in seconds.
        """
        numbers = self._seen.get(source)
        if numbers is None:
            if len(self._seen) >= self._sources:
                self._seen.popitem(last=False)
            self._seen[source] = {sequence: now}
            return False
        self._seen.move_to_end(source)
        before = numbers.get(sequence)
        if before is not None:
            if now - before < self._seconds:
                return True
            del numbers[sequence]
        elif len(numbers) >= self._history:
            del numbers[next(iter(numbers))]
        numbers[sequence] = now
        return False
