"""Joined messages: further topics or reports whose latest message is at hand for the main one.

Freshness is that of the arrival, by the steady clock of the bridge: clocks of other computers, and
stamps that nobody filled, do not matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..ends import parameters
from ..messages.limits import StaleJoinError
from .transcoding import ros_decoder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..ends.ends import Ends
    from ..ends.topics import Topic
    from .transcoding import Transcode


@dataclass(frozen=True)
class Join:
    """What the model says about a joined topic.

    Attributes:
        topics: Topics that are subscribed to; the latest message of any of them counts.
        freshness: Seconds after which the latest message is stale.
        drop: Whether a message of the main topic is dropped when there is nothing fresh. Otherwise
            its translation is given None.
    """

    name: str
    type: type[Any]
    topics: Sequence[Topic]
    freshness: float = 1.0
    drop: bool = False


class Joined:
    """The latest message of a join; it is made an object when somebody asks for it."""

    def __init__(self, name: str, *, freshness: float, drop: bool) -> None:
        """Keeps nothing yet.

        Args:
            drop: Whether the main message is dropped when there is nothing fresh.
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
        """Makes the parameter of the freshness.

        Args:
            owner: Connection and join, with which names of parameters begin.
        """
        self._ends = ends
        self._decode = decode
        self._arrival = self._data = self._latest = None
        stale = parameters.freshness(owner, self.freshness)
        self.freshness = ends.ros.parameter(stale, self._set_freshness)

    def fresh(self) -> Any:
        """Returns the latest message, or None when it is stale or there is none.

        Raises:
            StaleJoinError: There is nothing fresh, and the main message is dropped.
            DecodeError: The latest message cannot be read.
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
        """Returns the latest message as it came, or None when it is stale or there is none.

        Raises:
            StaleJoinError: There is nothing fresh, and the main message is dropped.
        """
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


class JoinedTopic(Joined):
    """The latest message of a joined topic."""

    def __init__(self, join: Join) -> None:
        super().__init__(join.name, freshness=join.freshness, drop=join.drop)
        self.join = join
        self.topics: tuple[Topic, ...] = ()

    def open(self, ends: Ends, connection: str, *, real: bool) -> None:
        """Makes the subscriptions."""
        owner = f"{connection}.{self.name}"
        self.begin(ends, owner, ros_decoder(ends.ros, self.join.type, real=real))
        self.topics = parameters.topics(ends.ros, owner, self.join.topics)
        for topic in self.topics:
            ends.shared_topics.feed(self.join.type, topic, self.keep)


def with_joins(
    transcode: Transcode, joined: Sequence[Joined], *, is_compiled: bool = False
) -> Transcode:
    """Returns a translation that is given the latest messages of joins.

    Args:
        is_compiled: Whether it asks joins itself, since it takes bytes first.
    """
    if is_compiled:
        asked = {each.name: each for each in joined}
        return lambda data: transcode(data, **asked)

    def transcode_joined(data: bytes) -> bytes | None:
        return transcode(data, **{each.name: each.fresh() for each in joined})

    return transcode_joined
