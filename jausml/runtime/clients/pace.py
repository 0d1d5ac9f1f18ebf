"""The pace of requests that stay unanswered."""

from __future__ import annotations

from ..base.address import JausAddress
from ..services.host import Host
from .presence import Presence

QUICK_TRIES = 8  # requests without an answer after which the pauses between them grow


class Pace:
    """Pauses between requests that stay unanswered: short ones first, then growing ones.

    While the peer is silent, they grow up to ``retry_max``. While messages of it arrive, the link
    only loses datagrams, and no pause is longer than ``watch_interval``.
    """

    def __init__(self, component: Host, address: JausAddress) -> None:
        self._settings = settings = component.settings
        self._presence = component.part(Presence)
        self._address = address
        self._tries = 0
        self._pause = settings.retry_min

    def answered(self) -> None:
        """Begins with short pauses again, after an answer."""
        self._tries = 0
        self._pause = self._settings.retry_min

    def next_pause(self) -> float:
        """Counts a request sent now; returns the seconds to wait for its answer."""
        self._tries += 1
        if self._tries < QUICK_TRIES:
            return self._pause
        is_heard = self._presence.heard_lately(self._address)
        longest = self._settings.watch_interval if is_heard else self._settings.retry_max
        pause = min(self._pause, longest)
        self._pause = min(2 * pause, self._settings.retry_max)
        return pause
