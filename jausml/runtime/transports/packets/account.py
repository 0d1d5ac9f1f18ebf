"""Account of what one sender sent to one component: what came, and what was lost on the way."""

from __future__ import annotations

import math
from itertools import islice
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections import OrderedDict

    Remembered = OrderedDict[int, tuple[float, Any]]

SPAN = 4096
"""Numbers by which a sender may go on between two messages that arrive, and within which a late one
is told from the first of a new life."""

NEAR = 2.0
"""Seconds between two packets in which no sender numbers ``SPAN`` of them."""

_EARLY = 64
_CERTAIN = 3
_ALL = (1 << SPAN) - 1


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

    Attributes:
        late: Those of them that came after newer ones.
        repeated: Packets that came again, too late to be known as duplicates.
        is_exact: Whether the sender surely does not number for all that it talks to: its numbers
            of packets to wildcards, which a single count would have taken among these, are others.
            Where this is not known, what was lost is an upper bound.
    """

    __slots__ = (
        "_began",
        "_compared",
        "_counted",
        "_doubted",
        "_gone",
        "_missing",
        "_top",
        "came",
        "is_exact",
        "late",
        "repeated",
        "restarts",
    )

    def __init__(self) -> None:
        self.came = 0
        self.late = 0
        self.repeated = 0
        self.restarts = 0
        self.is_exact = False
        self._counted = 0  # of the numbers that are remembered, the oldest of which are counted
        self._compared = -math.inf  # time of the packet to a wildcard that was looked at last
        self._top = -1
        self._began = 0  # the number of this life that was first is so many behind the newest
        self._missing = 0  # bit n: the number n behind the newest has not come
        self._gone = 0  # missing ones that are too far behind to be waited for
        self._doubted: list[int] = []

    @property
    def lost(self) -> int:
        """Packets that were sent and have not come so far."""
        return self._gone + self._missing.bit_count()

    @property
    def sent(self) -> int:
        """Packets that were sent, as far as those that came tell."""
        return self.came + self.lost

    def look(self, numbers: OrderedDict[int, Any]) -> None:
        """Count the packets that came since the last look.

        Args:
            numbers: Those that are remembered, in the order of arrival.
        """
        fresh = list(islice(reversed(numbers), len(numbers) - self._counted))
        for number in reversed(fresh):
            self._take(number)
        self._counted += len(fresh)

    def compare(self, numbers: Remembered, others: Remembered) -> None:
        """Learn from the latest packet to a wildcard whether what was lost is exact.

        Nothing is learnt where no packet came near it in time.

        Args:
            numbers: Those that are remembered, with their times, in the order of arrival.
        """
        number = next(reversed(others), None)
        if number is None or others[number][0] <= self._compared:
            return
        since = others[number][0]
        near = next((each for each in reversed(numbers) if numbers[each][0] <= since + NEAR), None)
        if near is not None and numbers[near][0] >= since - NEAR:
            self._compared = since
            self.is_exact = abs(_step(near, number)) > SPAN

    def note_repetition(self) -> None:
        """Learn that the newest of the numbers that are remembered is one that was counted before.

        A sender repeats for longer than duplicates are known while it hears no acknowledgement.
        """
        self._counted += 1
        self.repeated += 1

    def forget(self, amount: int) -> None:
        """Learn that so many of the numbers that were counted are remembered no more."""
        self._counted -= amount

    def _take(self, number: int) -> None:
        if self._top < 0:
            self._begin(number)
            return
        step = _step(self._top, number)
        if 0 < step <= SPAN:
            self._advance(step)
        elif -SPAN < step <= 0 and self._missing >> -step & 1:
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
        self.repeated += len(self._doubted)
        self._doubted.clear()

    def _advance(self, step: int) -> None:
        missing = self._missing << step | (1 << step) - 2
        self._gone += (missing >> SPAN).bit_count()
        self._missing = missing & _ALL
        self._top = self._top + step & 0xFFFF
        self._began = min(self._began + step, SPAN)

    def _doubt(self, number: int) -> None:
        """Take one that came before, or is far away: the sender began anew if more follow it."""
        if self._doubted and not 0 < (number - self._doubted[-1] & 0xFFFF) <= _EARLY:
            self.repeated += len(self._doubted)
            self._doubted.clear()
        self._doubted.append(number)
        if len(self._doubted) < _CERTAIN:
            return
        self._gone = self.lost
        self.restarts += 1
        numbers, self._doubted = self._doubted, []
        self._begin(numbers[0])
        for each in numbers[1:]:
            self._advance(each - self._top & 0xFFFF)
            self.came += 1

    def _begin(self, number: int) -> None:
        self._top = number
        self._began = self._missing = 0
        self.is_exact = False
        self.came += 1


def _step(first: int, second: int) -> int:
    """Returns by how much a number is ahead of another one, the shorter way around."""
    return ((second - first + 0x8000) & 0xFFFF) - 0x8000
