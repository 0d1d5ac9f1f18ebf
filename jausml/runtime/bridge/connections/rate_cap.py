"""Rate caps: how many messages a second are taken of one source, before they are translated.

A source that sends far more than it should would make the others wait. The cap stands before the
way that messages go anyway, and only where one is wanted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    Take = Callable[[bytes, Any], None]

OVER_RATE = "over_rate"
"""Messages of a source that sends more than its connection takes."""

_BURST_S = 1.0
_MOST_SOURCES = 256
_EVERYBODY_ELSE = "everybody else"


class RateCap:
    """Lets pass so many messages a second of each source, and a second's worth of them at once.

    What a source has sent is one number: the time until which it would have taken at the rate of
    the cap. Beyond a certain number of sources the others have one allowance together, so that
    many names are worth no more than one, and need no memory.
    """

    def __init__(
        self, hertz: float, clock: Callable[[], float], drop: Callable[[str, str], None]
    ) -> None:
        """Begins with no sources.

        Args:
            hertz: Messages each second that pass of one source, above 0.
        """
        self._interval = 1 / hertz
        # Half an interval of tolerance: clocks round.
        self._ahead = max(_BURST_S - self._interval, 0.0) + self._interval / 2
        self._clock = clock
        self._drop = drop
        self._until: dict[Any, float] = {}
        self._looked = clock()

    def before(self, way: Take) -> Take:
        """Returns what takes messages instead of a way, and gives it those that pass."""
        clock, drop, until = self._clock, self._drop, self._until
        interval, ahead = self._interval, self._ahead

        def take(data: bytes, sender: Any) -> None:
            now = clock()
            name = sender if sender in until else self._name(sender, now)
            taken = until.get(name, now)
            if taken - now > ahead:
                drop(OVER_RATE, str(name))
                return
            until[name] = max(taken, now) + interval
            way(data, sender)

        return take

    def _name(self, sender: Any, now: float) -> Any:
        """Returns under which name a new source has its allowance."""
        until = self._until
        if len(until) >= _MOST_SOURCES and now - self._looked >= _BURST_S:
            self._looked = now
            for name in [name for name, time in until.items() if time <= now]:
                del until[name]
        return sender if len(until) < _MOST_SOURCES else _EVERYBODY_ELSE
