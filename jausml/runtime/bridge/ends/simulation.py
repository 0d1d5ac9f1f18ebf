"""Simulated time for a bridge: its rates, time-outs and freshness follow `/clock`."""

from __future__ import annotations

import heapq
from collections.abc import Callable

from ...base.counters import LOGGER
from ...base.loop import Loop, Timer, due_after
from ..reports.diagnostics import ConnectionStatus
from ..reports.states import StopReason

SEEK = 10.0  # longest step of simulated time in seconds; a longer one is a jump
_WINDOW = 1.0  # real seconds over which the ratio is measured
_GAP = 0.5  # real seconds between two times from which on the simulation has paused
_TOLERANCE = 0.1  # relative change of the ratio that is ignored

# Real seconds without a time on `/clock` after which commands are stopped. A simulation that pauses
# goes on to publish the time; after one that has gone, commands would stay in effect for ever.
CLOCK_TIMEOUT = 3.0

_LEAST_RATE, _GREATEST_RATE = 0.1, 1092.0  # rates of events in hertz (AS5710, CreateEvent)


class SimulatedClock:
    """Clock of the seconds that a simulation has progressed since its first time on `/clock`.

    It pauses with the simulation. When simulated time goes back, or forward by more than `SEEK`,
    this clock goes on from its present value, so that timers keep the rest of their delay.

    Everything runs on the thread of the loop, or with its lock.

    Attributes:
        ratio: Measured simulated seconds in each real one; 1 before the first measurement, and
            unchanged while the simulation pauses.
        heard: Time of the loop at which the last time came on `/clock`; None before the first.
        seeks: Number of jumps of simulated time.
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
        """Returns the simulated seconds that have passed."""
        return self._progress

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback after a delay in simulated seconds."""
        return self.call_at(due_after(self._progress, delay_s), callback)

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback when this clock has reached a time."""
        timer = Timer(callback, lambda: None)
        while self._timers and self._timers[0][2].callback is None:
            heapq.heappop(self._timers)
        self._created += 1
        heapq.heappush(self._timers, (when, self._created, timer))
        return timer

    def follow_ratio(self, changed: Callable[[], None]) -> None:
        """Calls `changed` whenever the ratio has changed by more than a tenth."""
        self._followers.append(changed)

    def advance_to(self, seconds: float) -> None:
        """Takes a time of `/clock` in seconds, and runs the callbacks that are due."""
        real, former = self._loop.now(), self.heard
        step = 0.0 if former is None else seconds - self._latest
        self.heard, self._latest = real, seconds
        if step < 0 or step > SEEK:
            self.seeks += 1
            step, former = 0.0, None
        self._progress += step
        self._measure(real, former)
        self._run_due()

    def _measure(self, real: float, former: float | None) -> None:
        """Updates the ratio if two windows in a row agree: a single one may contain a pause."""
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
        newest = self._created  # timers that a callback sets wait for the next time
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
    """The simulated clock of a bridge, and the watch for silence on `/clock`."""

    def __init__(self, loop: Loop, stop: Callable[[StopReason], None]) -> None:
        """Waits for the first time; `stop` is called when `/clock` falls silent."""
        self.clock = SimulatedClock(loop)
        self.is_silent = False
        self._loop = loop
        self._stop = stop
        self._seeks = 0
        loop.call_later(CLOCK_TIMEOUT, self._check_silence)

    def take(self, seconds: float) -> None:
        """Takes a time of `/clock` in seconds."""
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

    def _check_silence(self) -> None:
        heard = self.clock.heard
        delay = CLOCK_TIMEOUT
        if heard is not None and not self.is_silent:
            delay = heard + CLOCK_TIMEOUT - self._loop.now()
            if delay <= 0:
                delay = CLOCK_TIMEOUT
                self.is_silent = True
                LOGGER.warning("nobody says the time on /clock; commands are stopped")
                self._stop(StopReason.CLOCK)
        self._loop.call_later(delay, self._check_silence)


def real_rate(rate: float, ratio: float) -> float:
    """Returns the real rate in hertz for a simulated one, within the limits of AS5710 events.

    Args:
        ratio: Simulated seconds in each real one.
    """
    return min(max(rate * ratio, _LEAST_RATE), _GREATEST_RATE)
