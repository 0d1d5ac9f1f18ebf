"""Detects duplicate packets, and counts lost ones by the gaps between their numbers."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice

from ...base.address import JausAddress
from .packet import Packet

Numbers = OrderedDict[int, tuple[float, int]]  # sequence numbers: time and hash of the payload

SPAN = 4096  # greatest step between numbers of one run of the sender; a greater one is a restart
NEAR = 2.0  # seconds in which no sender uses ``SPAN`` numbers
_EARLY = 64  # numbers before the first packet of a run that may still come
_CERTAIN = 3  # consecutive numbers that prove a restart: fewer may be late repetitions
_ALL = (1 << SPAN) - 1


@dataclass(slots=True, eq=False)
class Account:
    """Counts of the packets from one sender to one component, by sequence numbers (AS5669A).

    A sender numbers its packets consecutively, so that missing numbers are lost packets. They are
    not counted on arrival: the duplicate window stores them anyway, and `update` counts new ones.

    Packets after the last one that came are not known yet, and those lost around a restart of the
    sender are never known. A sender that restarts up to ``SPAN`` numbers ahead seems to have lost
    these. If it numbers packets to all destinations in one sequence, those to others seem lost:
    then ``lost`` is an upper bound.

    A run of the sender is the time between two restarts.
    """

    came: int = 0
    late: int = 0  # of those that came, the ones after newer ones
    duplicates: int = 0  # packets that came again soon, and were dropped
    repeated: int = 0  # packets that came again, too late to be dropped as duplicates
    restarts: int = 0
    # Whether the sender is known to have a sequence for this destination alone, as its numbers of
    # packets to wildcards are far away. Otherwise ``lost`` is an upper bound.
    is_exact: bool = False
    _counted: int = 0  # numbers in the window that are counted, from the oldest on
    _compared: float = -math.inf  # time of the last packet to a wildcard that was compared
    _newest: int = -1
    _began: int = 0  # distance of the first number of this run from the newest
    _missing: int = 0  # bit n: the number n behind the newest has not come
    _gone: int = 0  # missing numbers that are too far behind to come
    _doubted: list[int] = field(default_factory=list)  # may be the first numbers of a new run

    @property
    def lost(self) -> int:
        """Number of packets that have not come so far."""
        return self._gone + self._missing.bit_count()

    def update(self, numbers: Numbers) -> None:
        """Counts the numbers that are new since the last call, in the order of arrival."""
        fresh = list(islice(reversed(numbers), len(numbers) - self._counted))
        for number in reversed(fresh):
            self._take(number)
        self._counted += len(fresh)

    def compare(self, numbers: Numbers, others: Numbers) -> None:
        """Updates `is_exact` by the latest packet to a wildcard and one near it in time.

        Args:
            numbers: Numbers of packets to the component.
            others: Numbers of packets to wildcards.
        """
        number = next(reversed(others), None)
        if number is None or others[number][0] <= self._compared:
            return
        since = others[number][0]
        earlier = (other for other in reversed(numbers) if numbers[other][0] <= since + NEAR)
        near = next(earlier, None)
        if near is not None and numbers[near][0] >= since - NEAR:
            self._compared = since
            self.is_exact = abs(_step(near, number)) > SPAN

    def note_repetition(self) -> None:
        """Counts the newest number as a repetition that came too late to be a duplicate."""
        self._counted += 1
        self.repeated += 1

    def forget(self, amount: int) -> None:
        """Accounts for counted numbers that the window has forgotten."""
        self._counted -= amount

    def _take(self, number: int) -> None:
        if self._newest < 0:
            self._begin(number)
            return
        step = _step(self._newest, number)
        if 0 < step <= SPAN:
            self._advance(step)
        elif -SPAN < step <= 0 and self._missing >> -step & 1:
            # A missing number: the packet is late, and was not lost.
            self._missing ^= 1 << -step
            self.late += 1
        elif self._began < -step <= self._began + _EARLY and self._began < _EARLY:
            # Before the first of this run; those between the two may still come.
            self._missing |= (1 << -step) - (1 << self._began + 1)
            self._began = -step
            self.late += 1
        else:
            self._doubt(number)
            return
        self.came += 1
        # The sender has not restarted, so doubted numbers were repetitions.
        self.repeated += len(self._doubted)
        self._doubted.clear()

    def _advance(self, step: int) -> None:
        # Bit 0 is the newest; numbers between it and the former one are missing.
        missing = self._missing << step | (1 << step) - 2
        self._gone += (missing >> SPAN).bit_count()
        self._missing = missing & _ALL
        self._newest = self._newest + step & 0xFFFF
        self._began = min(self._began + step, SPAN)

    def _doubt(self, number: int) -> None:
        """Takes a repeated or distant number; the sender has restarted if others follow it."""
        if self._doubted and not 0 < (number - self._doubted[-1] & 0xFFFF) <= _EARLY:
            # It does not follow the one before, so that neither begins a new run.
            self.repeated += len(self._doubted)
            self._doubted.clear()
        self._doubted.append(number)
        if len(self._doubted) < _CERTAIN:
            return
        # No packet of the former run will come any more.
        self._gone = self.lost
        self.restarts += 1
        numbers, self._doubted = self._doubted, []
        self._begin(numbers[0])
        for sequence_number in numbers[1:]:
            self._advance(sequence_number - self._newest & 0xFFFF)
            self.came += 1

    def _begin(self, number: int) -> None:
        self._newest = number
        self._began = self._missing = 0
        self.is_exact = False
        self.came += 1


def _step(first: int, second: int) -> int:
    """Returns the difference of two numbers modulo 65536, from -32768 to 32767."""
    return ((second - first + 0x8000) & 0xFFFF) - 0x8000


_NO_NUMBERS: Numbers = OrderedDict()


def pair_of(source: int, destination: int) -> int:
    """Returns the key of the packets from one component to another."""
    return source << 32 | destination


class DuplicateWindow:
    """Remembers the latest packets of each pair of components (AS5669A, sequence numbers).

    A packet is a duplicate if its number came within ``seconds`` with the same content, among the
    latest ``history`` of its pair. The content is compared since a restarted component may use the
    same numbers again (Junior begins at 1), and a packet that is acknowledged and then dropped is
    lost. At most ``sources`` pairs are stored; the longest silent one is forgotten first. Packets
    to wildcards form a pair of their own, since they may have their own sequence.

    Attributes:
        history: Least number of packets that are remembered for a pair.
        capacity: Greatest number; then the oldest ones are forgotten together.
        seen: Numbers by pair, in the order of arrival; the longest silent pair is first. Those of a
            forgotten pair become empty.
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
        """Returns whether a packet came before, maybe with other flags; remembers it if not."""
        source, destination = packet.source, packet.destination
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
        """Yields sender, receiver and account of each pair; the longest silent one first."""
        for pair, numbers in self.seen.items():
            entry = self._accounts.get(pair)
            if entry is not None:
                entry[2].update(numbers)
                entry[2].compare(numbers, self.seen.get(pair_of(entry[0], 0), _NO_NUMBERS))
                yield entry

    def _begin(self, pair: int) -> Numbers:
        if len(self.seen) >= self._sources:
            forgotten, numbers = self.seen.popitem(last=False)
            # In place, so that other holders of these numbers notice it.
            numbers.clear()
            self._accounts.pop(forgotten, None)
            self._changed()
        self.seen[pair] = OrderedDict()
        return self.seen[pair]

    def _is_known(self, pair: int, numbers: Numbers, packet: Packet, now: float) -> bool:
        before = numbers.get(packet.sequence)
        is_same = False
        if before is not None:
            since, content = before
            # With the destination, as packets to all wildcards are one pair.
            is_same = content == hash(packet.payload) ^ packet.destination
            if now - since < self.seconds and is_same:
                if pair in self._accounts:
                    self._accounts[pair][2].duplicates += 1
                return True
            # Removed, to be added at the end with its new time.
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
        """Remembers a new packet, whose number is not in ``numbers``."""
        if len(numbers) >= self.capacity:
            # Many at once, so that this is rare.
            self._forget(pair, numbers, list(islice(numbers, len(numbers) - self.history + 1)))
        numbers[sequence] = now, hash(payload) ^ destination

    def _forget(self, pair: int, numbers: Numbers, sequences: list[int]) -> None:
        """Counts and forgets numbers."""
        entry = self._accounts.get(pair)
        if entry is not None:
            entry[2].update(numbers)
            entry[2].forget(len(sequences))
        for sequence in sequences:
            del numbers[sequence]
