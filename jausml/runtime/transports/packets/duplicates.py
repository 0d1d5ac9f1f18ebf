"""Duplicate detection by source, destination, sequence number and content."""

from __future__ import annotations

from collections import OrderedDict, deque
from itertools import islice
from typing import TYPE_CHECKING, Any

from .account import Account

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...base.address import JausAddress
    from .packet import Packet

    Content = int | tuple[int, bytes]
    Numbers = OrderedDict[int, tuple[float, Content]]

SMALL = 1024
"""Bytes of payload below which a content is remembered by its hash alone."""

_KEPT_BYTES = 4 << 20
_NONE: OrderedDict[int, tuple[float, Any]] = OrderedDict()


def pair_of(source: int, destination: int) -> int:
    """Returns a key for the packets from one component to another."""
    return source << 32 | destination


class DuplicateWindow:
    """Remembers the latest packets of each pair of components (AS5669A, sequence numbers).

    A packet is a duplicate when its number came within ``seconds`` with the same content and is
    among the latest ``history`` of its pair. The number alone does not tell: that of a component
    which restarts may begin anew, at 1 in each process of Junior, and what was acknowledged
    and then dropped is lost for good. At most ``sources`` pairs are remembered; the one
    silent longest goes first. Packets to wildcards are remembered apart from those to components,
    since they may be numbered apart.

    Large payloads are kept at first: a hash would cost as much as all else that is done about them.
    They are replaced by their hash when there is time, and the oldest when they exceed 4 MiB.

    Attributes:
        history: How many are remembered of each pair at least.
        capacity: How many are remembered at most; the oldest go together then, by ``make_room``.
        seen: By pair, the one silent longest first: its numbers, the oldest first, with time and
            content. That of a small payload is its hash and the destination. Those of a pair
            that is forgotten are empty.
    """

    def __init__(self, seconds: float = 1.5, history: int = 512, sources: int = 256) -> None:
        self.seconds = seconds
        self.history = history
        self.capacity = history + max(1, history // 2)
        self.seen: OrderedDict[int, Numbers] = OrderedDict()
        self._accounts: dict[int, tuple[JausAddress, JausAddress, Account]] = {}
        self._sources = sources
        self._kept: deque[tuple[float, int, int, tuple[int, bytes]]] = deque()
        self._kept_size = 0

    def __len__(self) -> int:
        """Return how many packets are remembered."""
        return sum(map(len, self.seen.values()))

    def is_duplicate(self, packet: Packet, now: float) -> bool:
        """Return whether the packet was seen before, and remember it.

        Args:
            packet: The packet; its flags may differ in a repetition.
        """
        source, destination = packet.source, packet.destination
        # A sender may number what goes to a wildcard by a count of its own.
        pair = pair_of(source, 0 if destination.is_wildcard else destination)
        numbers = self.seen.get(pair)
        if numbers is None:
            numbers = self._begin(pair)
            if not destination.is_wildcard:
                self._accounts[pair] = source, destination, Account()
        else:
            self.seen.move_to_end(pair)
        return self._is_known(pair, numbers, packet, now)

    def accounts(self) -> Iterator[tuple[JausAddress, JausAddress, Account]]:
        """Yield who sent to which component, and the account of it up to now.

        The one silent longest is first.
        The account of a pair ends when the pair is forgotten.
        """
        for pair, numbers in self.seen.items():
            entry = self._accounts.get(pair)
            if entry is not None:
                entry[2].look(numbers)
                entry[2].compare(numbers, self.seen.get(pair_of(entry[0], 0), _NONE))
                yield entry

    def _begin(self, pair: int) -> Numbers:
        if len(self.seen) >= self._sources:
            forgotten, numbers = self.seen.popitem(last=False)
            numbers.clear()
            self._accounts.pop(forgotten, None)
        self.seen[pair] = OrderedDict()
        return self.seen[pair]

    def _is_known(self, pair: int, numbers: Numbers, packet: Packet, now: float) -> bool:
        before = numbers.get(packet.sequence)
        is_same = False
        if before is not None:
            since, known = before
            is_same = known == _content(known, packet.destination, packet.payload)
            if now - since < self.seconds and is_same:
                return True
            self._forget(pair, numbers, [packet.sequence])
        self.remember(pair, numbers, packet.sequence, packet.destination, packet.payload, now)
        if is_same and pair in self._accounts:
            self._accounts[pair][2].note_repetition()
        return False

    def remember(
        self,
        pair: int,
        numbers: Numbers,
        sequence: int,
        destination: int,
        payload: bytes,
        now: float,
    ) -> None:
        """Remember a packet that is new, whose number is none of ``numbers``."""
        if len(numbers) >= self.capacity:
            self.make_room(pair, numbers)
        if len(payload) < SMALL:
            numbers[sequence] = now, hash(payload) ^ destination
        else:
            large = destination, payload
            numbers[sequence] = now, large
            self._keep(now, pair, sequence, large)

    def make_room(self, pair: int, numbers: Numbers) -> None:
        """Forget the oldest numbers of a pair, of which there are as many as can be."""
        self._forget(pair, numbers, list(islice(numbers, len(numbers) - self.history + 1)))

    def settle(self) -> None:
        """Let go of the payloads that are kept; to be called when there is time."""
        while self._kept:
            self._let_go()

    def _forget(self, pair: int, numbers: Numbers, sequences: list[int]) -> None:
        """Forget numbers when they are counted."""
        entry = self._accounts.get(pair)
        if entry is not None:
            entry[2].look(numbers)
            entry[2].forget(len(sequences))
        for each in sequences:
            del numbers[each]

    def _keep(self, now: float, pair: int, sequence: int, large: tuple[int, bytes]) -> None:
        """Keep a large payload, and let go of the oldest ones when there are too many."""
        self._kept.append((now, pair, sequence, large))
        self._kept_size += len(large[1])
        while self._kept_size > _KEPT_BYTES:
            self._let_go()

    def _let_go(self) -> None:
        """Replace the oldest payload that is kept by its hash, which suffices."""
        since, pair, sequence, large = self._kept.popleft()
        destination, payload = large
        self._kept_size -= len(payload)
        numbers = self.seen.get(pair)
        entry = None if numbers is None else numbers.get(sequence)
        if numbers is not None and entry is not None and entry[1] is large:
            numbers[sequence] = since, hash(payload) ^ destination


def _content(known: Content, destination: int, payload: bytes) -> Content:
    """Returns what a packet carries, in the form in which another one is remembered."""
    return hash(payload) ^ destination if isinstance(known, int) else (destination, payload)
