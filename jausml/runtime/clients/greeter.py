"""Greetings to components that say nothing before they are asked who they are."""

from __future__ import annotations

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..messages import QueryIdentification
from ..services.host import GREETING_PATIENCE, Host
from .presence import Presence

GREETING_INTERVAL = 5.0  # seconds between two greetings


class Greeter:
    """Asks peers for their identification until they speak, and again when they fall silent.

    Operator units of competitions, and components behind a router without multicast, learn of this
    component by that alone. Each peer gets one small query in ``GREETING_INTERVAL`` seconds at
    most, which is not repeated otherwise, and none while it was heard, with whatever message,
    within ``discovery_timeout`` of the settings: it may have been restarted after such a silence.
    """

    def __init__(self, component: Host) -> None:
        self._component = component
        self._presence = component.part(Presence)
        # How often each peer was greeted since it spoke last.
        self.unanswered = dict.fromkeys(component.settings.greeted, 0)
        self._timer = Alarm(component.loop)
        component.unanswered_greetings = self.unanswered
        component.when_started(self.start)
        component.when_stopped(self.stop)

    def start(self) -> None:
        """Greets now, and whoever is silent again and again."""
        for peer in self.unanswered:
            self._presence.watch(peer, self._heard)
        if self.unanswered:
            self._look()

    def stop(self) -> None:
        """Greets no more."""
        self._timer.cancel()
        for peer in self.unanswered:
            self._presence.forget(peer, self._heard)

    def _look(self) -> None:
        """Greets whoever was not heard for long."""
        component = self._component
        since = component.loop.now() - component.settings.discovery_timeout
        for peer in self.unanswered:
            if not self._presence.heard_since(peer, since):
                self._greet(peer)
        self._timer.set(GREETING_INTERVAL, self._look)

    def _greet(self, peer: JausAddress) -> None:
        self.unanswered[peer] += 1
        scope = self._component.settings.greeted[peer]
        self._component.counters.add("greeter.sent")
        self._component.send(QueryIdentification(query_type=scope), peer)
        if self.unanswered[peer] == GREETING_PATIENCE:
            self._component.counters.count(
                "greeter.unanswered", f"{peer} has answered none of {GREETING_PATIENCE} greetings"
            )

    def _heard(self) -> None:
        """Tells once of each peer that speaks after it was greeted."""
        since = self._component.loop.now() - self._component.settings.discovery_timeout
        for peer, tries in self.unanswered.items():
            if tries and self._presence.heard_since(peer, since):
                LOGGER.info("%s speaks, and is greeted no more", peer)
                self.unanswered[peer] = 0
