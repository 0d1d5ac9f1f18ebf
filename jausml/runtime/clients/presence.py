"""The times at which other components have sent their last message."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..base.address import JausAddress
from ..services.host import Host

SILENCE = 2.0  # seconds without a message after which a component that speaks again has come back


class Presence:
    """The time of the last message of each watched component, whatever its class."""

    def __init__(self, component: Host) -> None:
        self._loop = component.loop
        # Loop times of the last messages; kept up to date by the component's inbox.
        self.heard: dict[JausAddress, float] = {}
        self._on_return: dict[JausAddress, list[Callable[[], None]]] = {}

    def watch(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Watches a component; its first message, or one after a silence, calls the action."""
        self.heard.setdefault(address, -math.inf)
        self._on_return.setdefault(address, []).append(on_return)

    def note(self, address: JausAddress, at: float) -> None:
        """Notes the time of a message that took the fast path."""
        last = self.heard.get(address)
        if last is not None:
            self.heard[address] = at
            if at - last > SILENCE:
                self.returned(address)

    def forget(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Undoes ``watch``."""
        actions = self._on_return.get(address, [])
        if on_return in actions:
            actions.remove(on_return)
        if not actions:
            self._on_return.pop(address, None)
            self.heard.pop(address, None)

    def returned(self, address: JausAddress) -> None:
        """Calls the actions of a component that sends again, after its message is handled."""
        for action in self._on_return[address]:
            self._loop.call_soon(action)

    def heard_since(self, address: JausAddress, when: float) -> bool:
        """Returns whether a watched component has sent a message since a loop time."""
        return self.heard.get(address, -math.inf) >= when

    def heard_lately(self, address: JausAddress) -> bool:
        """Returns whether a watched component has sent a message within `SILENCE` seconds."""
        return self.heard_since(address, self._loop.now() - SILENCE)
