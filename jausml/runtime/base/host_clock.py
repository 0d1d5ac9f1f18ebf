"""Time as user code sees it."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .loop import Loop

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


class HostClock:
    """The clock of a component's host: that of this computer, or of a virtual world."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop

    def now(self) -> float:
        """Return seconds that never go back; only their differences mean anything."""
        return self._loop.now()

    def utc(self) -> datetime:
        """Return the time of day in UTC."""
        return _EPOCH + timedelta(microseconds=self._loop.wall() // 1000)
