"""Named counters: every message that the runtime drops is counted under a name."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable

LOGGER = logging.getLogger("jausml")
Clock = Callable[[], float]  # a monotonic time in seconds


class Tally:
    """A counter of one writer, which adds to ``count`` without a call or a lock."""

    __slots__ = ("count",)

    def __init__(self) -> None:
        self.count = 0


class Counters:
    """Counts by name, shared by all parts of a process; callable from any thread."""

    def __init__(self, clock: Clock = time.monotonic, log_interval: float = 5.0) -> None:
        self._clock = clock
        self._log_interval = log_interval
        self._lock = threading.Lock()
        self._counts: dict[str, int] = {}
        self._tallies: list[tuple[str, Tally]] = []
        self._logged: dict[str, tuple[float, int]] = {}

    def add(self, name: str, amount: int = 1) -> None:
        """Adds to the counter of a name, without logging."""
        with self._lock:
            self._counts[name] = self._counts.get(name, 0) + amount

    def tally(self, name: str) -> Tally:
        """Returns a part of the counter of a name, for one writer at a time; it is not logged."""
        tally = Tally()
        with self._lock:
            self._tallies.append((name, tally))
        return tally

    def count(
        self,
        name: str,
        detail: str = "",
        *,
        amount: int = 1,
        error: BaseException | None = None,
        level: int = logging.WARNING,
        once: bool = False,
    ) -> None:
        """Counts a drop or a failure and warns about it.

        The first one of a name is logged at once, later ones at most once in ``log_interval``
        seconds with their number since, so that a flood of bad datagrams is one line.

        Args:
            name: Area and reason, e.g. ``judp.bad_version``.
            detail: Peer, message or value, for the reader of the log.
            once: Whether only the first one of a name is logged.
        """
        now = self._clock()
        with self._lock:
            total = self._counts.get(name, 0) + amount
            self._counts[name] = total
            last, before = self._logged.get(name, (None, 0))
            if last is not None and (once or now - last < self._log_interval):
                return
            self._logged[name] = (now, total)
        times = total - before
        LOGGER.log(level, "%s (%d times): %s", name, times, detail, exc_info=error)

    def drops(self) -> dict[str, int]:
        """Returns only the counts that were logged, sorted by name."""
        with self._lock:
            return {name: self._counts[name] for name in sorted(self._logged)}

    def snapshot(self) -> dict[str, int]:
        """Returns a copy of all counts, sorted by name."""
        with self._lock:
            counts = dict(self._counts)
            for name, tally in self._tallies:
                if tally.count:
                    counts[name] = counts.get(name, 0) + tally.count
            return dict(sorted(counts.items()))
