"""Deadlines that are rarely met: most answers come in time."""

from __future__ import annotations

from functools import partial
from itertools import takewhile
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

    from .loop import Loop, Timer

T = TypeVar("T")


class Deadlines(Generic[T]):
    """Deadlines of what waits for answers, to be used while the lock of the loop is held.

    All that wait for the same time share one timer of the loop: what came later is due later, and
    a timer for each would be made and cancelled in vain.
    """

    def __init__(self, loop: Loop, on_due: Callable[[T], None]) -> None:
        self._loop = loop
        self._on_due = on_due
        self._due: dict[float, dict[T, float]] = {}  # by delay, in the order in which they are due
        self._timers: dict[float, Timer] = {}

    def add(self, item: T, delay: float) -> None:
        """Wait for an answer; nothing may wait twice for the same time.

        Args:
            delay: For how many seconds.
        """
        due = self._loop.now() + delay
        waiting = self._due.get(delay)
        if waiting is None:
            waiting = self._due[delay] = {}
            self._set_timer(delay, due)
        waiting[item] = due

    def discard(self, item: T, delay: float) -> None:
        """Wait no longer; no effect for what does not wait."""
        waiting = self._due.get(delay)
        if waiting is not None:
            waiting.pop(item, None)

    def clear(self) -> None:
        """Wait for nothing any more."""
        for timer in self._timers.values():
            timer.cancel()
        for waiting in self._due.values():
            waiting.clear()
        self._timers.clear()
        self._due.clear()

    def _set_timer(self, delay: float, due: float) -> None:
        self._timers[delay] = self._loop.call_at(due, partial(self._expire, delay))

    def _expire(self, delay: float) -> None:
        """Tell what is due; the next that will be has the timer then."""
        waiting, now = self._due.get(delay, {}), self._loop.now()
        late = list(takewhile(lambda item: waiting[item] <= now, waiting))
        try:
            for item in late:
                if waiting.pop(item, None) is not None:  # an earlier one may have ended its wait
                    self._on_due(item)
        finally:
            if waiting:
                self._set_timer(delay, next(iter(waiting.values())))
            else:
                self._due.pop(delay, None)
