"""Presence of the components that others are used by: when they were last heard."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Loop
    from ..services.definitions import ComponentSettings

QUICK_TRIES = 8
"""Requests without an answer after which the pauses between them grow."""

SILENCE = 2.0
"""Seconds without a message after which a component that speaks again has come back."""

_NEVER = float("-inf")


class Presence:
    """When each component that is waited for has sent its last message, of whatever kind.

    Attributes:
        heard: By component when that was; kept by who takes the messages.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self.heard: dict[JausAddress, float] = {}
        self._on_return: dict[JausAddress, list[Callable[[], None]]] = {}

    def watch(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Wait for a component.

        Args:
            on_return: Called when it speaks for the first time, or after a silence.
        """
        self.heard.setdefault(address, _NEVER)
        self._on_return.setdefault(address, []).append(on_return)

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
        return self.heard.get(address, _NEVER) >= when

    def heard_lately(self, address: JausAddress) -> bool:
        """Tell whether a component that is waited for is audible now."""
        return self.heard_since(address, self._loop.now() - SILENCE)


class Pace:
    """Pauses between requests that stay unanswered: short ones first, then growing ones.

    They grow up to ``retry_max`` while the other side is silent. While it is heard the link is
    there and only loses datagrams: then no pause is longer than ``watch_interval``.
    """

    def __init__(
        self, settings: ComponentSettings, presence: Presence, address: JausAddress
    ) -> None:
        self._settings = settings
        self._presence = presence
        self._address = address
        self._tries = 0
        self._pause = settings.retry_min

    def answered(self) -> None:
        """Begin anew: an answer has come."""
        self._tries = 0
        self._pause = self._settings.retry_min

    def next_pause(self) -> float:
        """Return the seconds to wait for the answer to a request that is sent now."""
        self._tries += 1
        if self._tries < QUICK_TRIES:
            return self._pause
        is_heard = self._presence.heard_lately(self._address)
        longest = self._settings.watch_interval if is_heard else self._settings.retry_max
        pause = min(self._pause, longest)
        self._pause = min(2 * pause, self._settings.retry_max)
        return pause
