"""Duplicate detection by source, sequence number and content."""

from __future__ import annotations

from collections import OrderedDict, deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .packet import Packet

    Content = int | tuple[int, bytes]
    Numbers = OrderedDict[int, tuple[float, Content]]

SMALL = 1024
"""Bytes of payload below which a content is remembered by its hash alone."""

_KEPT_BYTES = 4 << 20


class DuplicateWindow:
    """Remembers the latest packets of each source (AS5669A, sequence numbers).

    A packet is a duplicate when its number came within ``seconds`` with the same content and is
    among the latest ``history`` of its source. The number alone does not tell: that of a component
    which restarts may begin anew, at 1 in each process of Junior, and what was acknowledged
    and then dropped is lost for good. At most ``sources`` sources are remembered; the one
    silent longest goes first.

    Large payloads are kept at first: a hash would cost as much as all else that is done about them.
    They are replaced by their hash when there is time, and the oldest when they exceed 4 MiB.

    Attributes:
        seconds: How long a number is remembered.
        history: How many are remembered of each source.
        seen: By source, the one silent longest first: its numbers, the oldest first, with time and
            content. That of a small payload is its hash and the destination. Those of a source
            that is forgotten are empty.
    """

    def __init__(self, seconds: float = 1.5, history: int = 512, sources: int = 256) -> None:
        """Start with no packets seen."""
        self.seconds = seconds
        self.history = history
        self.seen: OrderedDict[int, Numbers] = OrderedDict()
        self._sources = sources
        self._kept: deque[tuple[float, Numbers, int, tuple[int, bytes]]] = deque()
        self._kept_size = 0

    def __len__(self) -> int:
        """Return how many packets are remembered."""
        return sum(map(len, self.seen.values()))

    def is_duplicate(self, packet: Packet, now: float) -> bool:
        """Return whether the packet was seen before, and remember it.

        Args:
            packet: The packet; numbers count per source, not per destination. Its flags may differ
                in a repetition.
            now: Time in seconds.
        """
        numbers = self.seen.get(packet.source)
        if numbers is None:
            if len(self.seen) >= self._sources:
                self.seen.popitem(last=False)[1].clear()
            numbers = self.seen[packet.source] = OrderedDict()
        else:
            self.seen.move_to_end(packet.source)
        return self.is_known(numbers, packet.sequence, packet.destination, packet.payload, now)

    def is_known(
        self, numbers: Numbers, sequence: int, destination: int, payload: bytes, now: float
    ) -> bool:
        """Return whether a source has sent a packet before, and remember it.

        Args:
            numbers: Those of the source, one of ``seen``.
            sequence: Number of the packet.
            destination: Where it goes.
            payload: What it carries.
            now: Time in seconds.
        """
        before = numbers.get(sequence)
        if before is not None:
            since, known = before
            if now - since < self.seconds and known == _content(known, destination, payload):
                return True
            del numbers[sequence]
        self.remember(numbers, sequence, destination, payload, now)
        return False

    def remember(
        self, numbers: Numbers, sequence: int, destination: int, payload: bytes, now: float
    ) -> None:
        """Remember a packet that is new, whose number is none of ``numbers``."""
        if len(numbers) >= self.history:
            numbers.popitem(last=False)
        if len(payload) < SMALL:
            numbers[sequence] = now, hash(payload) ^ destination
        else:
            large = destination, payload
            numbers[sequence] = now, large
            self._keep(now, numbers, sequence, large)

    def settle(self) -> None:
        """Let go of the payloads that are kept; to be called when there is time."""
        while self._kept:
            self._let_go()

    def _keep(self, now: float, numbers: Numbers, sequence: int, large: tuple[int, bytes]) -> None:
        """Keep a large payload, and let go of the oldest ones when there are too many."""
        self._kept.append((now, numbers, sequence, large))
        self._kept_size += len(large[1])
        while self._kept_size > _KEPT_BYTES:
            self._let_go()

    def _let_go(self) -> None:
        """Replace the oldest payload that is kept by its hash, which suffices."""
        since, numbers, sequence, large = self._kept.popleft()
        destination, payload = large
        self._kept_size -= len(payload)
        entry = numbers.get(sequence)
        if entry is not None and entry[1] is large:
            numbers[sequence] = since, hash(payload) ^ destination


def _content(known: Content, destination: int, payload: bytes) -> Content:
    """Returns what a packet carries, in the form in which another one is remembered."""
    return hash(payload) ^ destination if isinstance(known, int) else (destination, payload)
