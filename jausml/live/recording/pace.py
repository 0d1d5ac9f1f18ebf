"""Messages of a recording when their time has come."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from threading import Event

    from jausml.live.recording.bags import RosMessage

_NANO = 10**9
_TURN = 0.05
"""Seconds after which a pause begins or ends at the latest."""


class Pace:
    """The pace of a replay, which may be paused.

    Attributes:
        is_paused: Whether nothing passes; anybody may change it at any time.
        position: Seconds of the recording from the first message to the latest that has passed.
    """

    def __init__(self, speed: float, most_each_second: float, stop: Event) -> None:
        """Has passed nothing yet.

        Args:
            speed: Seconds of the recording in each second.
            most_each_second: How many messages pass at most; what comes faster is late.
        """
        self.is_paused = False
        self.position = 0.0
        self._speed = speed
        self._interval = 1 / most_each_second
        self._stop = stop
        self._paused = 0.0

    def messages(self, found: Iterable[RosMessage]) -> Iterator[RosMessage]:
        """Yields messages when their time has come; the first at once.

        Args:
            found: The messages, in the order of their times.
        """
        first, begin, free = None, 0.0, 0.0
        for each in found:
            if first is None:
                first, begin = each.time, self._now()
            since = (each.time - first) / _NANO
            due = max(begin + since / self._speed, free)
            if not self._waited(due):
                return
            free = max(due, self._now()) + self._interval
            self.position = since
            yield each

    def _now(self) -> float:
        """Returns the time of a clock that stands during pauses."""
        return time.monotonic() - self._paused

    def _waited(self, due: float) -> bool:
        """Waits for a time; returns whether it has come, and not the end."""
        while True:
            if self.is_paused:
                begin = time.monotonic()
                self._stop.wait(_TURN)
                self._paused += time.monotonic() - begin
            else:
                left = due - self._now()
                if left <= 0:
                    return not self._stop.is_set()
                self._stop.wait(min(left, _TURN))
            if self._stop.is_set():
                return False
