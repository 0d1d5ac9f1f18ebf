"""Queries at a rate, for a subscriber who shares an event that comes at every change.

A provider has one event for each query of a client (AS5710, CreateEvent): a second one with another
type would replace it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.loop import Loop, Timer


class Asking:
    """Asks at absolute times, so that the rate does not drift; a late loop does not catch up."""

    def __init__(self, loop: Loop, rate: float, ask: Callable[[float], object]) -> None:
        """Asks for the first time at once.

        Args:
            ask: Asks once; it is given the seconds until the next query.
        """
        self._loop = loop
        self._period = 1 / rate
        self._ask = ask
        self._next = loop.now()
        self._timer: Timer = loop.call_at(self._next, self._due)

    def stop(self) -> None:
        """Ask no more."""
        self._timer.cancel()

    def _due(self) -> None:
        self._next = max(self._next + self._period, self._loop.now())
        self._timer = self._loop.call_at(self._next, self._due)
        self._ask(self._period)
