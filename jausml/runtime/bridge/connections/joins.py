"""Joins: the latest messages of other topics or reports that a translation is given too.

Freshness counts from the arrival of a joined message, by the steady clock of the bridge: clocks of
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
    """The latest message of a join, which is decoded when a translation needs it."""

    def __init__(self, name: str, *, freshness: float, drop: bool) -> None:
        """Keeps no message yet.

        Args:
            freshness: Seconds after which the latest message is stale.
            drop: Whether the main message is dropped when there is no fresh joined one.
        """
        self.name = name
        self.freshness = freshness
        self._drop = drop
        self._ends: Ends
        self._decode: Callable[[bytes], Any]
        self._arrival: float | None = None
        self._data: bytes | None = None
        self._latest: Any = None

    def begin(self, ends: Ends, owner: str, decode: Callable[[bytes], Any]) -> None:
        """Declares the parameter of the freshness, and forgets messages of an earlier run.

        Args:
            owner: Connection and join, as the name of the parameter has them.
            decode: Decodes a message; raises DecodeError.
        """
        self._ends = ends
        self._decode = decode
        self._arrival = self._data = self._latest = None
        parameter = parameters.FRESHNESS.of(self.freshness, owner)
        self.freshness = ends.ros.parameter(parameter, self._set_freshness)

    def fresh(self) -> Any:
        """Returns the latest message, decoded; None when it is stale or there is none.

        Raises:
            StaleJoinError: Instead of None, where the main message is to be dropped.
            DecodeError: The message cannot be read.
        """
        data = self.fresh_data()
        if data is None:
            return None
        if self._latest is None:
            self._latest = self._decode(data)
        return self._latest

    def fresh_data(self) -> bytes | None:
        """Returns the latest message as bytes; None or a StaleJoinError as `fresh` does."""
        age = self.age
        if age is not None and age <= self.freshness:
            return self._data
        if self._drop:
            reason = "no message yet" if age is None else f"the latest message is {age:.3f} s old"
            raise StaleJoinError(self.name, reason)
        return None

    @property
    def age(self) -> float | None:
        """Seconds since the latest message arrived; None before the first."""
        arrival = self._arrival
        return None if arrival is None else self._ends.clock.now() - arrival

    @property
    def is_stale(self) -> bool:
        """Whether the latest message is too old, or there is none."""
        age = self.age
        return age is None or age > self.freshness

    def keep(self, data: bytes, _origin: Any = None) -> None:
        """Takes a message as the latest one."""
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
        """Keeps no message yet; `freshness` and `drop` are those of `Latest`.

        Unless `drop`, the translation is given None when there is no fresh message.
        """
        super().__init__(name, freshness=freshness, drop=drop)
        self._type = type
        self.topics = tuple(topics)

    def open(self, ends: Ends, connection: str, translate: Callable[..., Any]) -> None:
        """Makes the subscriptions, for the translation of a connection."""
        owner = f"{connection}.{self.name}"
        self.begin(ends, owner, ros_decoder(ends.ros, self._type, translate))
        self.topics = parameters.topics(ends.ros, owner, self.topics)
        for topic in self.topics:
            ends.shared_topics.feed(self._type, topic, self.keep)
