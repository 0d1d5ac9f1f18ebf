"""Joined topics: further ROS topics whose latest message is at hand when the main one delivers.

Freshness is that of the arrival, by the steady clock of the bridge: clocks of other computers, and
stamps that nobody filled, do not matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import parameters
from .errors import StaleJoinError
from .transcoding import ros_decoder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .ends import Ends
    from .topics import Topic


@dataclass(frozen=True)
class Join:
    """What the model says about a joined topic.

    Attributes:
        name: Name, which is that of the parameter of the translation.
        type: ROS type of the topics.
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


class JoinedTopic:
    """The latest message of a joined topic; it is made an object when somebody asks for it."""

    def __init__(self, join: Join) -> None:
        """Keeps nothing yet.

        Args:
            join: What the model says.
        """
        self.join = join
        self.freshness = join.freshness
        self.topics: tuple[Topic, ...] = ()
        self._ends: Ends
        self._decode: Callable[[bytes], Any]
        self._arrival: float | None = None
        self._data: bytes | None = None
        self._latest: Any = None

    def open(self, ends: Ends, connection: str, *, real: bool) -> None:
        """Makes the subscriptions.

        Args:
            ends: The bridge.
            connection: Name of the connection, with which those of parameters begin.
            real: Whether objects of the message class of ROS are wanted.
        """
        self._ends = ends
        self._decode = ros_decoder(ends.ros, self.join.type, real=real)
        name = f"{connection}.{self.join.name}"
        stale = parameters.freshness(name, self.freshness)
        self.freshness = ends.ros.parameter(stale, self._set_freshness)
        self.topics = parameters.topics(ends.ros, name, self.join.topics)
        for topic in self.topics:
            ends.subscribe(self.join.type, topic, self._keep)

    def fresh(self) -> Any:
        """Returns the latest message, or None when it is stale or there is none.

        Raises:
            StaleJoinError: There is nothing fresh, and the message of the main topic is dropped.
            DecodeError: The latest message cannot be read.
        """
        if not self.is_stale:
            if self._data is not None:
                self._latest, self._data = self._decode(self._data), None
            return self._latest
        if self.join.drop:
            age = self.age
            reason = "no message yet" if age is None else f"the latest message is {age:.3f} s old"
            raise StaleJoinError(self.join.name, reason)
        return None

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

    def _set_freshness(self, seconds: float) -> None:
        self.freshness = seconds

    def _keep(self, data: bytes, _stamp: int = 0) -> None:
        self._arrival, self._data = self._ends.clock.now(), data
