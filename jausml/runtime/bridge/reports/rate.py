"""How many messages come each second, for sources that are fast or slow."""

from __future__ import annotations

from collections import deque

PERIODS = 3
"""Periods of a source over which its rate is taken, if they are longer than one of diagnostics."""

_MOST = 1000


class Rate:
    """The rate of a connection, from one status to the next."""

    def __init__(self) -> None:
        self._noted: deque[tuple[float, int]] = deque(maxlen=_MOST)
        self.hertz = 0.0
        self.is_slow = False

    def note(self, now: float, arrivals: int, declared: float) -> None:
        """Takes the rate since the last call, or over more of them for a slow source.

        Args:
            now: Time in seconds.
            declared: Messages each second that the source promises; 0 when it promises none.
        """
        span = PERIODS / declared if declared > 0 else 0.0
        noted = self._noted
        while len(noted) > 1 and noted[1][0] <= now - span:
            noted.popleft()
        since, before = noted[0] if noted else (now, arrivals)
        noted.append((now, arrivals))
        elapsed = now - since
        self.hertz = (arrivals - before) / elapsed if elapsed > 0 else 0.0
        self.is_slow = 0 < span <= elapsed and self.hertz < declared / 2
