"""When each component was last heard, and greetings to those that say nothing by themselves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..messages import QueryIdentification

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..services.host import Host

SILENCE = 2.0
"""Seconds without a message after which a component that speaks again has come back."""


class Presence:
    """When each component that is waited for has sent its last message, of whatever kind.

    Attributes:
        heard: By component when that was; kept by who takes the messages.
    """

    def __init__(self, component: Host) -> None:
        self._loop = component.loop
        self.heard: dict[JausAddress, float] = {}
        self._on_return: dict[JausAddress, list[Callable[[], None]]] = {}

    def watch(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Wait for a component.

        Args:
            on_return: Called when it speaks for the first time, or after a silence.
        """
        self.heard.setdefault(address, -math.inf)
        self._on_return.setdefault(address, []).append(on_return)

    def note(self, address: JausAddress, at: float) -> None:
        """Note a message of a component, which did not pass those who take messages."""
        last = self.heard.get(address)
        if last is not None:
            self.heard[address] = at
            if at - last > SILENCE:
                self.returned(address)

    def forget(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Undo ``watch``."""
        actions = self._on_return.get(address, [])
        if on_return in actions:
            actions.remove(on_return)
        if not actions:
            self._on_return.pop(address, None)
            self.heard.pop(address, None)

    def returned(self, address: JausAddress) -> None:
        """Tell who waits for a component that it speaks again, after what its message says."""
        for action in self._on_return[address]:
            self._loop.call_soon(action)

    def heard_since(self, address: JausAddress, when: float) -> bool:
        """Tell whether a component that is waited for has sent a message since a time."""
        return self.heard.get(address, -math.inf) >= when

    def heard_lately(self, address: JausAddress) -> bool:
        """Tell whether a component that is waited for is audible now."""
        return self.heard_since(address, self._loop.now() - SILENCE)


GREETING_INTERVAL = 5.0
"""Seconds between two greetings."""

PATIENCE = 3
"""Greetings without an answer after which somebody is told, once in each silence."""


class Greeter:
    """Asks peers for their identification until they speak, and again when they fall silent.

    Operator units of competitions, and components behind a router without multicast, learn of
    this component by that alone. Each peer gets one small query in ``GREETING_INTERVAL`` seconds at
    most, which is not repeated otherwise, and none while it was heard, with whatever message,
    within ``discovery_timeout`` of the settings: it may have been restarted after such a silence.

    Attributes:
        unanswered: How often each peer was greeted since it spoke last.
    """

    def __init__(self, component: Host) -> None:
        self._component = component
        self._presence = component.part(Presence)
        self.unanswered = dict.fromkeys(component.settings.greeted, 0)
        self._timer = Alarm(component.loop)
        component.when_stopped(self.stop)

    def start(self) -> None:
        """Greet now, and whoever is silent again and again."""
        for peer in self.unanswered:
            self._presence.watch(peer, self._heard)
        if self.unanswered:
            self._look()

    def stop(self) -> None:
        """Greet no more."""
        self._timer.cancel()
        for peer in self.unanswered:
            self._presence.forget(peer, self._heard)

    def _look(self) -> None:
        """Greet whoever was not heard for long."""
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
        if self.unanswered[peer] == PATIENCE:
            self._component.counters.count(
                "greeter.unanswered", f"{peer} has answered none of {PATIENCE} greetings"
            )

    def _heard(self) -> None:
        """Tell once of each peer that speaks after it was greeted."""
        since = self._component.loop.now() - self._component.settings.discovery_timeout
        for peer, tries in self.unanswered.items():
            if tries and self._presence.heard_since(peer, since):
                LOGGER.info("%s speaks, and is greeted no more", peer)
                self.unanswered[peer] = 0
