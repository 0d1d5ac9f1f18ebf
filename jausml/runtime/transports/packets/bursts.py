"""Bursts: how many packets a receiver can be trusted to take in one go."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...base.address import JausAddress

AT_ONCE = 10
"""Packets that a receiver takes in one go."""

PER_SECOND = 8000
"""Packets that it takes in a second."""

_MAX_DESTINATIONS = 256


class Bursts:
    """Tells whether packets of a large message can go out in one go, without acknowledgement.

    A node manager of Junior takes 10 datagrams each millisecond, and its receive buffer holds about
    20 of full size; what comes on top is lost in silence.
    """

    def __init__(self) -> None:
        self._levels: dict[JausAddress, tuple[float, float]] = {}

    def fits(self, destination: JausAddress, count: int, now: float) -> bool:
        """Return whether a destination can take packets now, and assume that it gets them if so."""
        level, since = self._levels.get(destination, (0.0, now))
        level = max(0.0, level - (now - since) * PER_SECOND) + count
        if level > AT_ONCE:
            return False
        if len(self._levels) >= _MAX_DESTINATIONS:
            self._levels.clear()
        self._levels[destination] = level, now
        return True
