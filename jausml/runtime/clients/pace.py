"""The pace of requests that stay unanswered."""

from __future__ import annotations

from ..base.address import JausAddress
from ..services.host import Host
from .presence import Presence

QUICK_TRIES = 8  # requests without an answer after which the pauses between them grow


class Pace:
    """Pauses between requests that stay unanswered: short ones first, then growing ones.

    They grow up to ``retry_max`` while the other side is silent. While it is heard the link is
    there and only loses datagrams: then no pause is longer than ``watch_interval``.
    """

    def __init__(self, component: Host, address: JausAddress) -> None:
        self._settings = settings = component.settings
        self._presence = component.part(Presence)
        self._address = address
        self._tries = 0
        self._pause = settings.retry_min

    def answered(self) -> None:
        """Begins anew: an answer has come."""
        self._tries = 0
        self._pause = self._settings.retry_min

    def next_pause(self) -> float:
        """Returns the seconds to wait for the answer to a request that is sent now."""
        self._tries += 1
        if self._tries < QUICK_TRIES:
            return self._pause
        is_heard = self._presence.heard_lately(self._address)
        longest = self._settings.watch_interval if is_heard else self._settings.retry_max
        pause = min(self._pause, longest)
        self._pause = min(2 * pause, self._settings.retry_max)
        return pause
