"""Clocks of a loop or a simulation, and alarms on them."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta, timezone
from typing import Protocol

from .loop import Loop, Timer

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


class HostClock:
    """The clock of a component's host: that of this computer, or of a virtual world."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop

    def now(self) -> float:
        """Returns seconds since an arbitrary time, which never go back."""
        return self._loop.now()

    def utc(self) -> datetime:
        """Returns the time of day in UTC."""
        return _EPOCH + timedelta(microseconds=self._loop.wall() // 1000)


class Timing(Protocol):
    """A steady clock and its timers; `Loop` is one of real time.

    To be used on the thread of the loop, or with its lock.
    """

    def now(self) -> float:
        """Returns the time in seconds, which never goes back."""

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback at a time of this clock."""

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback after a delay in seconds of this clock."""


class Alarm:
    """A timer that can be set again, which cancels its former callback.

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
        """Runs a callback after a delay in seconds."""
        self.cancel()
        self._timer = self._clock.call_later(delay_s, callback)

    def set_at(self, when: float, callback: Callable[[], None]) -> None:
        """Runs a callback at a time of the clock."""
        self.cancel()
        self._timer = self._clock.call_at(when, callback)

    def cancel(self) -> None:
        """Cancels the callback; no effect without one."""
        if self._timer is not None:
            self._timer.cancel()
