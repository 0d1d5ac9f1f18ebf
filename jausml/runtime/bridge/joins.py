"""Joined topics: further ROS topics whose latest message is at hand when the main one delivers.

Freshness is that of the arrival, by the steady clock of the bridge: clocks of other computers, and
stamps that nobody filled, do not matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import parameters
from .errors import StaleJoinError

if TYPE_CHECKING:
    from collections.abc import Sequence

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
    """The latest message of a joined topic. All but its age is used on the thread of ROS alone."""

    def __init__(self, join: Join) -> None:
        """Keeps nothing yet.

        Args:
            join: What the model says.
        """
        self.join = join
        self.freshness = join.freshness
        self.topics: tuple[Topic, ...] = ()
        self._ends: Ends
        self._latest: tuple[float, Any] | None = None

    def open(self, ends: Ends, connection: str) -> None:
        """Makes the subscriptions.

        Args:
            ends: The bridge.
            connection: Name of the connection, with which those of parameters begin.
        """
        self._ends = ends
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
        """
        if self._latest is not None and not self.is_stale:
            return self._latest[1]
        if self.join.drop:
            age = self.age
            reason = "no message yet" if age is None else f"the latest message is {age:.3f} s old"
            raise StaleJoinError(self.join.name, reason)
        return None

    @property
    def age(self) -> float | None:
        """Seconds since the latest message arrived; None before the first."""
        latest = self._latest
        return None if latest is None else self._ends.loop.now() - latest[0]

    @property
    def is_stale(self) -> bool:
        """Whether there is nothing fresh."""
        age = self.age
        return age is None or age > self.freshness

    def _set_freshness(self, seconds: float) -> None:
        self.freshness = seconds

    def _keep(self, message: Any) -> None:
        self._latest = self._ends.loop.now(), message
