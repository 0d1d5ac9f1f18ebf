"""A bridge beside a simulation: rates, time-outs and freshness follow `/clock`."""

from __future__ import annotations

import heapq
from collections.abc import Callable

from ...base.counters import LOGGER
from ...base.loop import Loop, Timer, due_after
from ..reports.diagnostics import ConnectionStatus
from ..reports.states import StopReason

SEEK = 10.0
"""Seconds of simulated time in one step that are no time that passed, but another place in it."""

_WINDOW = 1.0  # real seconds over which the ratio is measured
_GAP = 0.5  # real seconds between two times that are a pause of the simulation, not slowness
_TOLERANCE = 0.1  # part by which the ratio may change before anybody is told

CLOCK_TIMEOUT = 3.0
"""Real seconds without a word on `/clock` after which commands are stopped.

A simulation that rests goes on to say the time; one that is gone would let commands stand forever.
"""

_LEAST_RATE, _GREATEST_RATE = 0.1, 1092.0  # rates of events in hertz (AS5710, CreateEvent)


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
        """Returns the seconds that have passed."""
        return self._progress

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback after a delay in simulated seconds."""
        return self.call_at(due_after(self._progress, delay_s), callback)

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback at a time of this clock, when the simulation says that it is there."""
        timer = Timer(callback, lambda: None)
        while self._timers and self._timers[0][2].callback is None:
            heapq.heappop(self._timers)
        self._created += 1
        heapq.heappush(self._timers, (when, self._created, timer))
        return timer

    def follow_ratio(self, changed: Callable[[], None]) -> None:
        """Calls a function when the simulation has become clearly faster or slower."""
        self._followers.append(changed)

    def advance_to(self, seconds: float) -> None:
        """Takes the time that the simulation says, and runs what is due."""
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
        """Tells the ratio of two windows on end that agree: one alone may hold part of a pause."""
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


class Simulation:
    """The clock of a bridge that follows `/clock`, and the watch over it."""

    def __init__(self, loop: Loop, stop: Callable[[StopReason], None]) -> None:
        """Waits for the first time; before it, nothing ends by time."""
        self.clock = SimulatedClock(loop)
        self.is_silent = False
        self._loop = loop
        self._stop = stop
        self._seeks = 0
        loop.call_later(CLOCK_TIMEOUT, self._look)

    def take(self, seconds: float) -> None:
        """Takes a time of the simulation."""
        self.is_silent = False
        self.clock.advance_to(seconds)
        if self.clock.seeks > self._seeks:
            self._seeks = self.clock.seeks
            detail = f"to {seconds:.3f} s; what waits for a time goes on waiting as long as before"
            self._loop.counters.count("bridge.clock_jumped", detail)

    def status(self, hardware_id: str) -> ConnectionStatus:
        """Returns the state of the clock for `/diagnostics`."""
        clock = self.clock
        level, message = "ok", f"simulated time runs at {clock.ratio:.2f} of real time"
        if clock.heard is None:
            level, message = "stale", "nothing was heard on /clock yet"
        elif self.is_silent:
            level, message = "stale", StopReason.CLOCK.value
        values = (("ratio to real time", f"{clock.ratio:.2f}"), ("jumps", str(clock.seeks)))
        return ConnectionStatus("simulated time", level, message, hardware_id, values)

    def _look(self) -> None:
        heard = self.clock.heard
        left = CLOCK_TIMEOUT
        if heard is not None and not self.is_silent:
            left = heard + CLOCK_TIMEOUT - self._loop.now()
            if left <= 0:
                left = CLOCK_TIMEOUT
                self.is_silent = True
                LOGGER.warning("nobody says the time on /clock; commands are stopped")
                self._stop(StopReason.CLOCK)
        self._loop.call_later(left, self._look)


def real_rate(rate: float, ratio: float) -> float:
    """Returns the real rate of events, within AS5710, that are to come at a simulated one.

    The ratio is of simulated seconds to real ones.
    """
    return min(max(rate * ratio, _LEAST_RATE), _GREATEST_RATE)
