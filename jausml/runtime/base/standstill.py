"""Standstills: notices when the process did not run, after which waiting messages are old."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Protocol

# Returns seconds that never go back. Unlike `time.monotonic`, they include those for which the
# computer was suspended, in which messages have waited.
steady: Callable[[], float] = partial(
    time.clock_gettime, getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)
)

_BEATS = 4  # beats within the shortest limit
_SHORTEST = 0.02  # shortest limit in seconds: a beat costs some microseconds
_RELAYED = 0.1  # seconds for messages held by relays of the host, which may have stood still, too
_MAX_TURNS = 256  # turns in which a socket is emptied, also while more arrives without a pause


class Waiting(Protocol):
    """The part of a loop that a standstill uses."""

    now: Callable[[], float]

    def call_soon(self, callback: Callable[[], object]) -> None:
        """Runs a callback in the next turn."""

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Cancellable:
        """Runs a callback after a delay in seconds."""

    def is_idle(self) -> bool:
        """Returns whether no descriptor is ready."""


class Cancellable(Protocol):
    """A callback that is planned."""

    def cancel(self) -> None:
        """Keeps it from running."""


class Watch:
    """A pair of callbacks for standstills above a limit; made by `Standstill.watch`."""

    def __init__(
        self,
        standstill: Standstill,
        limit: float,
        began: Callable[[float], None],
        caught_up: Callable[[], None],
    ) -> None:
        self._standstill = standstill
        self.limit, self.began, self.caught_up = limit, began, caught_up

    def change(self, limit: float) -> None:
        """Sets the limit in seconds; 0 means no call."""
        self.limit = limit
        self._standstill.arrange()

    def cancel(self) -> None:
        """Ends the calls."""
        self._standstill.forget(self)


class Standstill:
    """Notices that a loop did not turn for long, before it serves the messages that waited.

    A message in a socket has no time of arrival, and timestamps of the kernel would slow down each
    message. But while the loop turns, no message waits long. So a beat notes the time, and each
    reader of a socket checks the beat first: if it is late, all waiting messages may be as old. A
    process may be stopped by a debugger or a frozen container, suspended with its computer, starved
    by others, or held up by a callback of its own; the messages are as old in each case.

    Attributes:
        due: Loop time from which the next beat is later than a limit; a reader after that calls
            ``end`` first.
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
        """Has `began` called with the seconds of each standstill above a limit in seconds.

        It is called before waiting messages are served, and `caught_up` after all of them are. The
        caller holds the lock of the loop.
        """
        watch = Watch(self, limit, began, caught_up)
        self._watches.append(watch)
        self.arrange()
        return watch

    def forget(self, watch: Watch) -> None:
        """Removes a watch; no effect if removed."""
        if watch in self._watches:
            self._watches.remove(watch)
            self.arrange()

    def arrange(self) -> None:
        """Sets the interval of the beat by the limits; a simulated clock has no standstills."""
        # The former limits hold for the time until now.
        self.check()
        if self._beat is not None:
            self._beat.cancel()
            self._beat = None
        limits = [max(watch.limit, _SHORTEST) for watch in self._watches if watch.limit > 0]
        is_real = self._loop.now is steady
        self._limit = min(limits, default=math.inf) if is_real else math.inf
        self._note_turn()

    def check(self) -> None:
        """Ends a standstill, if there is one; to be called before a socket is read."""
        if self._loop.now() > self.due:
            self.end()

    def end(self) -> None:
        """Calls the watches of a standstill that ends now."""
        now = self._loop.now()
        still = now - self._turned
        # First, as callbacks may check again, and must find no standstill.
        self._turned, self.due = now, now + self._limit
        watches = [watch for watch in self._watches if 0 < watch.limit < still]
        # One round of catching up serves all watches.
        if watches and not self._behind:
            self._loop.call_later(_RELAYED, self._catch_up)
        self._behind += [watch for watch in watches if watch not in self._behind]
        # A further standstill restarts the round.
        self._relayed, self._turns = now + _RELAYED, 0
        for watch in watches:
            watch.began(still)

    def _beat_once(self) -> None:
        self.check()
        self._note_turn()

    def _note_turn(self) -> None:
        self._turned = self._loop.now()
        self.due = self._turned + self._limit
        if self.due < math.inf:
            self._beat = self._loop.call_later(self._limit / _BEATS, self._beat_once)

    def _catch_up(self) -> None:
        """Calls `caught_up` of the watches, once no descriptor is ready."""
        delay = self._relayed - self._loop.now()
        if delay > 0:
            self._loop.call_later(delay, self._catch_up)
            return
        self._turns += 1
        if not self._loop.is_idle() and self._turns < _MAX_TURNS:
            self._loop.call_soon(self._catch_up)
            return
        behind, self._behind = self._behind, []
        for watch in behind:
            watch.caught_up()
