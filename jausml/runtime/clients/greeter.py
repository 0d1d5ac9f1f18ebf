"""Greetings to components that send nothing before they are queried for their identification."""

from __future__ import annotations

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..messages import QueryIdentification
from ..services.host import GREETING_PATIENCE, Host
from .presence import Presence

GREETING_INTERVAL = 5.0  # seconds between two greetings


class Greeter:
    """Queries peers for their identification until they send, and again when they fall silent.

    Operator units of competitions, and components behind a router without multicast, learn of this
    component only so. Each peer gets at most one query in ``GREETING_INTERVAL`` seconds, which the
    transport does not repeat. It gets none if it has sent any message within the last
    ``discovery_timeout`` seconds; after a longer silence, it may have been restarted.
    """

    def __init__(self, component: Host) -> None:
        self._component = component
        self._presence = component.part(Presence)
        # Greetings to each peer since its last message.
        self.unanswered = dict.fromkeys(component.settings.greeted, 0)
        self._timer = Alarm(component.loop)
        component.unanswered_greetings = self.unanswered
        component.when_started(self.start)
        component.when_stopped(self.stop)

    def start(self) -> None:
        """Greets silent peers now, and every ``GREETING_INTERVAL`` seconds."""
        for peer in self.unanswered:
            self._presence.watch(peer, self._log_returned)
        if self.unanswered:
            self._greet_silent_peers()

    def stop(self) -> None:
        """Stops greeting."""
        self._timer.cancel()
        for peer in self.unanswered:
            self._presence.forget(peer, self._log_returned)

    def _greet_silent_peers(self) -> None:
        component = self._component
        since = component.loop.now() - component.settings.discovery_timeout
        for peer in self.unanswered:
            if not self._presence.heard_since(peer, since):
                self._greet(peer)
        self._timer.set(GREETING_INTERVAL, self._greet_silent_peers)

    def _greet(self, peer: JausAddress) -> None:
        self.unanswered[peer] += 1
        scope = self._component.settings.greeted[peer]
        self._component.counters.add("greeter.sent")
        self._component.send(QueryIdentification(query_type=scope), peer)
        if self.unanswered[peer] == GREETING_PATIENCE:
            self._component.counters.count(
                "greeter.unanswered", f"{peer} has answered none of {GREETING_PATIENCE} greetings"
            )

    def _log_returned(self) -> None:
        """Logs each peer that sends for the first time since its greeting."""
        since = self._component.loop.now() - self._component.settings.discovery_timeout
        for peer, greetings in self.unanswered.items():
            if greetings and self._presence.heard_since(peer, since):
                LOGGER.info("%s speaks, and is greeted no more", peer)
                self.unanswered[peer] = 0
