"""Standstills: tells when the process did not run for a while, as what waited then is old."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Protocol

steady: Callable[[], float] = partial(
    time.clock_gettime, getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)
)
"""Returns seconds that never go back, also those for which the computer was suspended.

The usual clock, `time.monotonic`, rests while the computer does: by it nothing has waited then.
"""

_LOOKS = 4  # beats in the shortest time that somebody wants to know of
_SHORTEST = 0.02  # seconds below which nothing is a standstill: a beat costs some microseconds
_RELAYED = 0.1  # seconds for what relays of the host have held, which may have stood still as well

_MOST_TURNS = 256
"""Turns in which a socket gives all that it can hold, also while more comes without a pause."""


class Waiting(Protocol):
    """What a loop offers to whoever waits."""

    now: Callable[[], float]

    def call_soon(self, callback: Callable[[], object]) -> None:
        """Runs a callback in the next turn."""

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Cancellable:
        """Runs a callback after a delay in seconds."""

    def is_idle(self) -> bool:
        """Tells whether nothing waits to be served."""


class Cancellable(Protocol):
    """A callback that is planned."""

    def cancel(self) -> None:
        """Keeps it from running."""


class Watch:
    """Somebody who is to know of a standstill; see `Standstill.watch`."""

    def __init__(
        self,
        standstill: Standstill,
        limit: float,
        began: Callable[[float], None],
        caught_up: Callable[[], None],
    ) -> None:
        """Use ``Standstill.watch`` instead."""
        self._standstill = standstill
        self.limit, self.began, self.caught_up = limit, began, caught_up

    def change(self, limit: float) -> None:
        """Wants to know of standstills of another length in seconds from now on; 0 for none."""
        self.limit = limit
        self._standstill.arrange()

    def cancel(self) -> None:
        """Wants to know of nothing any more."""
        self._standstill.forget(self)


class Standstill:
    """Notices that a loop did not turn for long, before it serves what waited meanwhile.

    What waits in a socket does not say since when, and to have the kernel tell costs each message.
    But no message of a process that turns has waited long. So a beat notes the time while it
    turns, and whoever reads looks at the beat first: if it is late, all that waits may be as old as
    that. A process is stopped by a debugger or a frozen container, suspended with its computer,
    starved by others, or held up by a callback of its own; the messages are as old in each case.

    Attributes:
        due: When the next beat is so late that somebody is to know, by the loop; whoever
            reads later than that calls ``end`` first.
    """

    def __init__(self, loop: Waiting) -> None:
        self.due = self._limit = math.inf
        self._loop = loop
        self._turned = self._relayed = loop.now()
        self._watches: list[Watch] = []
        self._behind: list[Watch] = []
        self._beat: Cancellable | None = None
        self._turns = 0

    def watch(
        self,
        limit: float,
        began: Callable[[float], None],
        caught_up: Callable[[], None] = lambda: None,
    ) -> Watch:
        """Tells of standstills before what waited is served; called with the lock of the loop."""
        watch = Watch(self, limit, began, caught_up)
        self._watches.append(watch)
        self.arrange()
        return watch

    def forget(self, watch: Watch) -> None:
        """Tells of nothing any more; no effect when that is so already."""
        if watch in self._watches:
            self._watches.remove(watch)
            self.arrange()

    def arrange(self) -> None:
        """Beats as often as the watches need it; no time passes unseen by another clock."""
        # What stood still until now is judged by the limits of until now.
        self.look()
        if self._beat is not None:
            self._beat.cancel()
            self._beat = None
        limits = [max(watch.limit, _SHORTEST) for watch in self._watches if watch.limit > 0]
        is_real = self._loop.now is steady
        self._limit = min(limits, default=math.inf) if is_real else math.inf
        self._note_turn()

    def look(self) -> None:
        """Notices a standstill, if there was one; whoever reads calls it before."""
        if self._loop.now() > self.due:
            self.end()

    def end(self) -> None:
        """Tells of a standstill that ends now."""
        now = self._loop.now()
        still = now - self._turned
        # First, as those who are told may look again and must find it told.
        self._turned, self.due = now, now + self._limit
        watches = [watch for watch in self._watches if 0 < watch.limit < still]
        # One round of catching up serves all who are behind.
        if watches and not self._behind:
            self._loop.call_later(_RELAYED, self._catch_up)
        self._behind += [watch for watch in watches if watch not in self._behind]
        # A further standstill begins the round anew.
        self._relayed, self._turns = now + _RELAYED, 0
        for watch in watches:
            watch.began(still)

    def _beat_once(self) -> None:
        self.look()
        self._note_turn()

    def _note_turn(self) -> None:
        self._turned = self._loop.now()
        self.due = self._turned + self._limit
        if self.due < math.inf:
            self._beat = self._loop.call_later(self._limit / _LOOKS, self._beat_once)

    def _catch_up(self) -> None:
        """Tells that all has been served, once nothing waits for a moment."""
        left = self._relayed - self._loop.now()
        if left > 0:
            self._loop.call_later(left, self._catch_up)
            return
        self._turns += 1
        if not self._loop.is_idle() and self._turns < _MOST_TURNS:
            self._loop.call_soon(self._catch_up)
            return
        behind, self._behind = self._behind, []
        for watch in behind:
            watch.caught_up()
