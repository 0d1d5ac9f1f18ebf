"""When each component was last heard."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..base.address import JausAddress
from ..services.host import Host

SILENCE = 2.0  # seconds without a message after which a component that speaks again has come back


class Presence:
    """When each component that is waited for has sent its last message, of whatever kind."""

    def __init__(self, component: Host) -> None:
        self._loop = component.loop
        # By component when that was; kept by who takes the messages.
        self.heard: dict[JausAddress, float] = {}
        self._on_return: dict[JausAddress, list[Callable[[], None]]] = {}

    def watch(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Waits for a component; the action is called when it speaks first, or after a silence."""
        self.heard.setdefault(address, -math.inf)
        self._on_return.setdefault(address, []).append(on_return)

    def note(self, address: JausAddress, at: float) -> None:
        """Notes a message of a component, which did not pass those who take messages."""
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
        """Tells who waits for a component that it speaks again, after what its message says."""
        for action in self._on_return[address]:
            self._loop.call_soon(action)

    def heard_since(self, address: JausAddress, when: float) -> bool:
        """Tells whether a component that is waited for has sent a message since a time."""
        return self.heard.get(address, -math.inf) >= when

    def heard_lately(self, address: JausAddress) -> bool:
        """Tells whether a component that is waited for is audible now."""
        return self.heard_since(address, self._loop.now() - SILENCE)
