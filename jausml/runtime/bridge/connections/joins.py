"""Joins: the latest messages of other topics or reports that a translation is given too.

Freshness of what is joined is that of its arrival, by the steady clock of the bridge: clocks of
other computers, and stamps that nobody filled, do not matter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ..ends import parameters
from ..ends.ends import Ends
from ..ends.topics import Topic
from ..messages.limits import StaleJoinError
from .translations import ros_decoder


class Latest:
    """The latest message of a join; it is made an object when somebody asks for it."""

    def __init__(self, name: str, *, freshness: float, drop: bool) -> None:
        """Keeps nothing yet; the main message may be dropped when there is nothing fresh."""
        self.name = name
        self.freshness = freshness
        self._drop = drop
        self._ends: Ends
        self._decode: Callable[[bytes], Any]
        self._arrival: float | None = None
        self._data: bytes | None = None
        self._latest: Any = None

    def begin(self, ends: Ends, owner: str, decode: Callable[[bytes], Any]) -> None:
        """Makes the parameter of the freshness, which names connection and join."""
        self._ends = ends
        self._decode = decode
        self._arrival = self._data = self._latest = None
        stale = parameters.FRESHNESS.of(self.freshness, owner)
        self.freshness = ends.ros.parameter(stale, self._set_freshness)

    def fresh(self) -> Any:
        """Returns the latest message, or None when it is stale or there is none.

        Where the main message is dropped then, that is a StaleJoinError; a DecodeError, where it
        cannot be read.
        """
        if not self.is_stale:
            if self._latest is None and self._data is not None:
                self._latest = self._decode(self._data)
            return self._latest
        if self._drop:
            age = self.age
            reason = "no message yet" if age is None else f"the latest message is {age:.3f} s old"
            raise StaleJoinError(self.name, reason)
        return None

    def fresh_data(self) -> bytes | None:
        """Returns the latest message as it came; of what is not fresh, as `fresh` does."""
        # When it is stale: that raises an error, or says None.
        return self._data if not self.is_stale else self.fresh()

    @property
    def age(self) -> float | None:
        """Seconds since the latest message arrived; None before the first."""
        arrival = self._arrival
        return None if arrival is None else self._ends.clock.now() - arrival

    @property
    def is_stale(self) -> bool:
        """Whether there is nothing fresh."""
        age = self.age
        return age is None or age > self.freshness

    def keep(self, data: bytes, _origin: Any = None) -> None:
        """Takes a message, which is the latest one from now on."""
        self._arrival, self._data, self._latest = self._ends.clock.now(), data, None

    def _set_freshness(self, seconds: float) -> None:
        self.freshness = seconds


class Join(Latest):
    """The latest message of a joined topic, or of any of several."""

    def __init__(
        self,
        name: str,
        type: type[Any],  # noqa: A002 - the word of the model
        topics: Sequence[Topic],
        freshness: float = 1.0,
        *,
        drop: bool = False,
    ) -> None:
        """Keeps nothing yet.

        Args:
            freshness: Seconds after which the latest message is stale.
            drop: Whether a message of the main topic is dropped when there is nothing fresh.
                Otherwise its translation is given None.
        """
        super().__init__(name, freshness=freshness, drop=drop)
        self._type = type
        self.topics = tuple(topics)

    def open(self, ends: Ends, connection: str, *, real: bool) -> None:
        """Makes the subscriptions."""
        owner = f"{connection}.{self.name}"
        self.begin(ends, owner, ros_decoder(ends.ros, self._type, real=real))
        self.topics = parameters.topics(ends.ros, owner, self.topics)
        for topic in self.topics:
            ends.shared_topics.feed(self._type, topic, self.keep)
