"""Commands that waited while the process stood still: none that waited for too long is obeyed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..reports.diagnostics import TOO_OLD

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.loop import Timer
    from ...base.standstill import Watch
    from ..ends.ends import Ends
    from ..reports.diagnostics import Statistics

    Take = Callable[[bytes, Any], None]
    Drop = Callable[[str, str], None]

_REPEATED = 5.0
"""Seconds after a standstill in which the middleware of ROS may still bring what was sent before.

It repeats what a reader has missed when the writer tells of it, which Fast DDS does each 3 s.
"""


class Backlog:
    """Stands before the way that the commands of a connection go anyway, after a standstill alone.

    A time-out of silence says how long a command may stand. One that waited longer, before anybody
    could notice the silence, counts no more either. Where nothing says when a message was sent,
    all that waited is refused: the next one is on its way.
    """

    def __init__(
        self, counts: Statistics, drop: Drop, waited: Callable[[Any], float | None]
    ) -> None:
        """Refuses nothing before `open`.

        Args:
            waited: Returns the seconds since a message with an origin was sent; None when nobody
                knows.
        """
        self._counts, self._drop, self._waited = counts, drop, waited
        self._ends: Ends
        self._changed: Callable[[], None]
        self._way: Take
        self._watch: Watch | None = None
        self._end: Timer | None = None
        self._limit = self._still = 0.0
        self._has_caught_up = True

    @property
    def is_there(self) -> bool:
        """Whether a message may have waited."""
        return self._end is not None

    def open(self, ends: Ends, limit: float, changed: Callable[[], None]) -> None:
        """Begins to look for standstills.

        Args:
            limit: Seconds that a command may have waited; 0 for any time.
            changed: Called when there is a backlog, before any of it is taken, and when there is
                none any more.
        """
        self._ends, self._changed, self._limit = ends, changed, limit
        self._watch = ends.loop.standstill.watch(limit, self._stood_still, self._caught_up)

    def close(self) -> None:
        """Looks no more."""
        if self._watch is not None:
            self._watch.cancel()
        self._finish()

    def change(self, limit: float) -> None:
        """Lets commands have waited for another time from now on."""
        self._limit = limit
        if self._watch is not None:
            self._watch.change(limit)

    def before(self, way: Take) -> Take:
        """Returns what takes messages instead, and gives a way those that are young enough."""
        self._way = way
        return self._take

    def _take(self, data: bytes, origin: Any = None) -> None:
        waited = self._waited(origin)
        if waited is None and not self._has_caught_up:
            waited = self._still
        if waited is None or self._limit <= 0 or waited <= self._limit:
            self._way(data, origin)
            return
        self._counts.arrivals += 1
        self._counts.last_arrival = self._ends.clock.now()
        self._drop(TOO_OLD, f"it waited up to {waited:.2f} s while the process stood still")

    def _stood_still(self, seconds: float) -> None:
        self._finish()
        self._still, self._has_caught_up = seconds, False
        self._end = self._ends.loop.call_later(_REPEATED, self._over)
        self._changed()

    def _caught_up(self) -> None:
        self._has_caught_up = True

    def _over(self) -> None:
        self._finish()
        self._changed()

    def _finish(self) -> None:
        if self._end is not None:
            self._end.cancel()
            self._end = None
