"""A bridge beside a simulation: rates, time-outs and freshness follow `/clock`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.clocks import SimulatedClock
from ...base.counters import LOGGER
from ..reports.diagnostics import ConnectionStatus
from ..reports.states import StopReason

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.loop import Loop

CLOCK_TIMEOUT = 3.0
"""Real seconds without a word on `/clock` after which commands are stopped.

A simulation that rests goes on to say the time; one that is gone would let commands stand forever.
"""

_LEAST_RATE, _GREATEST_RATE = 0.1, 1092.0
"""Rates of events in hertz (AS5710, CreateEvent)."""


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
    """Returns the rate in real time of events that a simulation shall see at a rate.

    Args:
        rate: Events in each simulated second.
        ratio: Simulated seconds in each real one.

    Returns:
        Events in each real second, within what AS5710 can ask for.
    """
    return min(max(rate * ratio, _LEAST_RATE), _GREATEST_RATE)
