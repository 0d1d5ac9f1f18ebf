"""Finds packets that come twice, and tells by the gaps of their numbers how many are lost."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice

from ...base.address import JausAddress
from .packet import Packet

Numbers = OrderedDict[int, tuple[float, int]]
"""Numbers of packets, each with its time and the hash of what it carried."""


SPAN = 4096
"""Numbers by which a sender may go on between two messages that arrive, and within which a late one
is told from the first of a new life."""

NEAR = 2.0  # seconds between two packets in which no sender numbers ``SPAN`` of them

# How far before the first packet that came others of the same life may still come.
_EARLY = 64
# Numbers in a row that prove a restart: one or two may be late repetitions.
_CERTAIN = 3
_ALL = (1 << SPAN) - 1


@dataclass(slots=True, eq=False)
class Account:
    """What the sequence numbers of one sender tell (AS5669A).

    A sender numbers its packets one after the other, so the numbers that never came are those that
    were lost. Nothing is done for it while a message arrives: the memory that finds duplicates
    holds the numbers anyway, and what is new in it is counted now and then.

    What was sent after the last packet that came is not known before the next one comes; what was
    lost around a restart of the sender is never known. One that begins anew at up to ``SPAN``
    numbers beyond its last looks as if so many were lost. Where the sender counts for all it talks
    to, and not for each component, what it sent to others looks lost: ``lost`` is an upper bound
    then.
    """

    came: int = 0
    late: int = 0  # those of them that came after newer ones
    doubled: int = 0  # packets that came again soon, and were dropped as duplicates
    repeated: int = 0  # packets that came again, too late to be known as duplicates
    restarts: int = 0
    # Whether the sender surely does not number for all that it talks to: its numbers of packets to
    # wildcards, which a single count would have taken among these, are others. Where this is not
    # known, what was lost is an upper bound.
    is_exact: bool = False
    _counted: int = 0  # of the numbers that are remembered, the oldest of which are counted
    _compared: float = -math.inf  # time of the packet to a wildcard that was looked at last
    _top: int = -1
    _began: int = 0  # the number of this life that was first is so many behind the newest
    _missing: int = 0  # bit n: the number n behind the newest has not come
    _gone: int = 0  # missing ones that are too far behind to be waited for
    _doubted: list[int] = field(default_factory=list)

    @property
    def lost(self) -> int:
        """Packets that were sent and have not come so far."""
        return self._gone + self._missing.bit_count()

    def look(self, numbers: Numbers) -> None:
        """Counts the packets that came since the last look, by numbers in the order of arrival."""
        # From the newest back to those that are counted, as the memory is long.
        fresh = list(islice(reversed(numbers), len(numbers) - self._counted))
        for number in reversed(fresh):
            self._take(number)
        self._counted += len(fresh)

    def compare(self, numbers: Numbers, others: Numbers) -> None:
        """Learns from the latest packet to a wildcard whether what was lost is exact.

        Nothing is learnt where no packet came near it in time.
        """
        number = next(reversed(others), None)
        if number is None or others[number][0] <= self._compared:
            return
        since = others[number][0]
        near = next(
            (
                sequence_number
                for sequence_number in reversed(numbers)
                if numbers[sequence_number][0] <= since + NEAR
            ),
            None,
        )
        if near is not None and numbers[near][0] >= since - NEAR:
            self._compared = since
            self.is_exact = abs(_step(near, number)) > SPAN

    def note_repetition(self) -> None:
        """Learns that the newest of the numbers that are remembered is one that was counted before.

        A sender repeats for longer than duplicates are known while it hears no acknowledgement.
        """
        self._counted += 1
        self.repeated += 1

    def forget(self, amount: int) -> None:
        """Learns that so many of the numbers that were counted are remembered no more."""
        self._counted -= amount

    def _take(self, number: int) -> None:
        if self._top < 0:
            self._begin(number)
            return
        step = _step(self._top, number)
        if 0 < step <= SPAN:
            self._advance(step)
        elif -SPAN < step <= 0 and self._missing >> -step & 1:
            # Among the missing: it is late, and was not lost.
            self._missing ^= 1 << -step
            self.late += 1
        elif self._began < -step <= self._began + _EARLY and self._began < _EARLY:
            # Overtaken by the first one that came; those between the two may still come.
            self._missing |= (1 << -step) - (1 << self._began + 1)
            self._began = -step
            self.late += 1
        else:
            self._doubt(number)
            return
        self.came += 1
        # The sender goes on where it was, so those in doubt were repetitions.
        self.repeated += len(self._doubted)
        self._doubted.clear()

    def _advance(self, step: int) -> None:
        # Bit 0 is the newest, which has come; those between it and the former one are missing.
        missing = self._missing << step | (1 << step) - 2
        self._gone += (missing >> SPAN).bit_count()
        self._missing = missing & _ALL
        self._top = self._top + step & 0xFFFF
        self._began = min(self._began + step, SPAN)

    def _doubt(self, number: int) -> None:
        """Takes one that came before, or is far away: the sender began anew if more follow it."""
        if self._doubted and not 0 < (number - self._doubted[-1] & 0xFFFF) <= _EARLY:
            # It does not follow the one before, so that neither is part of a new life.
            self.repeated += len(self._doubted)
            self._doubted.clear()
        self._doubted.append(number)
        if len(self._doubted) < _CERTAIN:
            return
        # Of the former life nothing will come any more.
        self._gone = self.lost
        self.restarts += 1
        numbers, self._doubted = self._doubted, []
        # What was in doubt were the first packets of the new life.
        self._begin(numbers[0])
        for sequence_number in numbers[1:]:
            self._advance(sequence_number - self._top & 0xFFFF)
            self.came += 1

    def _begin(self, number: int) -> None:
        self._top = number
        self._began = self._missing = 0
        self.is_exact = False
        self.came += 1


def _step(first: int, second: int) -> int:
    """Returns by how much a number is ahead of another one, the shorter way around."""
    return ((second - first + 0x8000) & 0xFFFF) - 0x8000


_NONE: OrderedDict[int, tuple[float, int]] = OrderedDict()


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

    Attributes:
        history: How many are remembered of each pair at least.
        capacity: How many are remembered at most; the oldest go together then.
        seen: By pair, the one silent longest first: its numbers, the oldest first, with time and
            the hash of the content. Those of a pair that is forgotten are empty.
    """

    def __init__(
        self,
        seconds: float = 1.5,
        history: int = 512,
        sources: int = 256,
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        self.seconds = seconds
        self.history = history
        self.capacity = history + max(1, history // 2)
        self.seen: OrderedDict[int, Numbers] = OrderedDict()
        self._accounts: dict[int, tuple[JausAddress, JausAddress, Account]] = {}
        self._sources = sources
        self._changed = changed

    def __len__(self) -> int:
        return sum(map(len, self.seen.values()))

    def is_duplicate(self, packet: Packet, now: float) -> bool:
        """Returns whether the packet was seen before, maybe with other flags, and remembers it."""
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
        """Yields who sent to which component, and the account of it up to now.

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
            # In place: whoever holds the numbers of this pair finds them empty, and knows.
            numbers.clear()
            self._accounts.pop(forgotten, None)
            self._changed()
        self.seen[pair] = OrderedDict()
        return self.seen[pair]

    def _is_known(self, pair: int, numbers: Numbers, packet: Packet, now: float) -> bool:
        before = numbers.get(packet.sequence)
        is_same = False
        if before is not None:
            since, known = before
            # With the destination: packets to all wildcards are remembered together.
            is_same = known == hash(packet.payload) ^ packet.destination
            if now - since < self.seconds and is_same:
                if pair in self._accounts:
                    self._accounts[pair][2].doubled += 1
                return True
            # Taken out, to stand at the end with its new time.
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
        """Remembers a packet that is new, whose number is none of ``numbers``."""
        if len(numbers) >= self.capacity:
            # Many at once, so that not each packet has to make room.
            self._forget(pair, numbers, list(islice(numbers, len(numbers) - self.history + 1)))
        numbers[sequence] = now, hash(payload) ^ destination

    def _forget(self, pair: int, numbers: Numbers, sequences: list[int]) -> None:
        """Forgets numbers when they are counted."""
        entry = self._accounts.get(pair)
        if entry is not None:
            entry[2].look(numbers)
            entry[2].forget(len(sequences))
        for sequence in sequences:
            del numbers[sequence]
