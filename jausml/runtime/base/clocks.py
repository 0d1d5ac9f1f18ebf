"""Clocks beside that of the loop: the time of day, and that of a simulation.

Timers of the latter run as fast as the simulation does.
"""

from __future__ import annotations

import heapq
from datetime import datetime, timedelta, timezone
from typing import TYPE_CHECKING, Protocol

from .loop import Timer, due_after

if TYPE_CHECKING:
    from collections.abc import Callable

    from .loop import Loop


_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


class HostClock:
    """The clock of a component's host: that of this computer, or of a virtual world."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop

    def now(self) -> float:
        """Return seconds that never go back; only their differences mean anything."""
        return self._loop.now()

    def utc(self) -> datetime:
        """Return the time of day in UTC."""
        return _EPOCH + timedelta(microseconds=self._loop.wall() // 1000)


SEEK = 10.0
"""Seconds of simulated time in one step that are no time that passed, but another place in it."""

_WINDOW = 1.0
"""Real seconds over which the ratio is measured."""

_GAP = 0.5
"""Real seconds between two times that are a pause of the simulation, not slowness."""

_TOLERANCE = 0.1
"""Part by which the ratio may change before anybody is told."""


class Timing(Protocol):
    """A steady clock and its timers; `Loop` has those of real time.

    To be used on the thread of the loop, or with its lock.
    """

    def now(self) -> float:
        """Return the time in seconds, which never goes back."""

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Run a callback at a time of this clock."""

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Run a callback after a delay in seconds of this clock."""


class Alarm:
    """A timer that is set again and again: what it was set to before is dropped then.

    To be used on the thread of the loop, or with its lock.
    """

    __slots__ = ("_clock", "_timer")

    def __init__(self, clock: Timing) -> None:
        self._clock = clock
        self._timer: Timer | None = None

    @property
    def is_set(self) -> bool:
        """Whether a callback is still to run."""
        return self._timer is not None and self._timer.callback is not None

    def set(self, delay_s: float, callback: Callable[[], None]) -> None:
        """Run a callback after a delay in seconds."""
        self.cancel()
        self._timer = self._clock.call_later(delay_s, callback)

    def set_at(self, when: float, callback: Callable[[], None]) -> None:
        """Run a callback at a time of the clock."""
        self.cancel()
        self._timer = self._clock.call_at(when, callback)

    def cancel(self) -> None:
        """Run nothing any more; no effect when nothing is to run."""
        if self._timer is not None:
            self._timer.cancel()


class SimulatedClock:
    """Seconds that a simulation has progressed since its first time was heard.

    It rests while the simulation rests. A simulation that begins anew, or that somebody moves by
    more than `SEEK`, goes on counting from where it was: timers keep what remained of them, as
    nothing has happened meanwhile that they could have waited for.

    All of it runs on the thread of the loop, or with its lock.

    Attributes:
        ratio: Simulated seconds in each real one, as measured; 1 before that, and the last one
            while the simulation rests.
        heard: Time of the loop when the simulation last said its time; None before the first.
        seeks: How often the time went back or was moved.
    """

    def __init__(self, loop: Loop) -> None:
        self.ratio = 1.0
        self.heard: float | None = None
        self.seeks = 0
        self._loop = loop
        self._progress = 0.0
        self._latest = 0.0
        self._timers: list[tuple[float, int, Timer]] = []
        self._created = 0
        self._window = (0.0, 0.0)  # real time and progress at its beginning
        self._candidate = 1.0
        self._followers: list[Callable[[], None]] = []

    def now(self) -> float:
        """Return the seconds that have passed."""
        return self._progress

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Run a callback after a delay in simulated seconds."""
        return self.call_at(due_after(self._progress, delay_s), callback)

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Run a callback at a time of this clock, when the simulation says that it is there."""
        timer = Timer(callback, lambda: None)
        while self._timers and self._timers[0][2].callback is None:
            heapq.heappop(self._timers)
        self._created += 1
        heapq.heappush(self._timers, (when, self._created, timer))
        return timer

    def follow_ratio(self, changed: Callable[[], None]) -> None:
        """Call a function when the simulation has become clearly faster or slower."""
        self._followers.append(changed)

    def advance_to(self, seconds: float) -> None:
        """Take the time that the simulation says, and run what is due."""
        real, former = self._loop.now(), self.heard
        step = 0.0 if former is None else seconds - self._latest
        self.heard, self._latest = real, seconds
        if step < 0 or step > SEEK:
            self.seeks += 1
            step = 0.0
            former = None
        self._progress += step
        self._measure(real, former)
        self._run_due()

    def _measure(self, real: float, former: float | None) -> None:
        """Tell the ratio of two windows on end that agree: one alone may hold part of a pause."""
        began, progress = self._window
        if former is None or real - former > _GAP:
            self._window = real, self._progress
            return
        if real - began < _WINDOW:
            return
        measured = (self._progress - progress) / (real - began)
        self._window = real, self._progress
        agrees = abs(measured - self._candidate) <= _TOLERANCE * measured
        self._candidate = measured
        if measured > 0 and agrees and abs(measured - self.ratio) > _TOLERANCE * self.ratio:
            self.ratio = measured
            for follower in self._followers:
                self._run(follower)

    def _run_due(self) -> None:
        newest = self._created  # what a callback asks for waits for the next time
        while self._timers and self._timers[0][0] <= self._progress:
            if self._timers[0][1] > newest:
                return
            _, _, timer = heapq.heappop(self._timers)
            callback, timer.callback = timer.callback, None
            if callback is not None:
                self._run(callback)

    def _run(self, callback: Callable[[], object]) -> None:
        try:
            callback()
        except Exception as error:
            self._loop.counters.count("clock.callback_failed", repr(error), error=error)
