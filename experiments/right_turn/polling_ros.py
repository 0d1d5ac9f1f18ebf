"""The ROS side of a bridge that polls: it looks at both sides at a frequency, not at messages.

The paper's bridge was given a frequency when it was started. Its code is not public, so this is
told from its text: of what arrived on either side since the last look the newest is carried, and
the rest is gone. The generated bridge itself is left as it is; only its topics are held.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class Held:
    """The newest value since the last look.

    Attributes:
        overwritten: Values that a newer one replaced before they were looked at.
    """

    def __init__(self, deliver: Callable[..., object]) -> None:
        """Hold nothing yet; `deliver` takes what is held at each look."""
        self.overwritten = 0
        self._deliver = deliver
        self._value: tuple[Any, ...] | None = None

    def put(self, *value: Any) -> None:
        """Hold a value instead of the one before."""
        self.overwritten += self._value is not None
        self._value = value

    def look(self) -> None:
        """Deliver what is held, if anything is."""
        value, self._value = self._value, None
        if value is not None:
            self._deliver(*value)


class _HeldPublisher:
    """A publisher that publishes at the next look."""

    def __init__(self, publisher: Any, held: Held) -> None:
        self._publisher = publisher
        self.publish = held.put

    @property
    def matched(self) -> int:
        return int(self._publisher.matched)

    @property
    def unmatched(self) -> int:
        return int(self._publisher.unmatched)

    @unmatched.setter
    def unmatched(self, value: int) -> None:
        self._publisher.unmatched = value


class PollingRos:
    """A ROS side whose topics are looked at from time to time; all else is that of the inner one.

    Attributes:
        held: What is held, in the order in which topics were made.
    """

    def __init__(self, ros: Any, frequency: float, phase: float = 0.0) -> None:
        """Prepare to poll.

        Args:
            ros: The ROS side that is held.
            frequency: Looks each second.
            phase: Seconds until the first look.
        """
        self.held: list[Held] = []
        self._ros = ros
        self._period = 1.0 / frequency
        self._phase = phase

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ros, name)

    def attach(self, loop: Any) -> None:
        """Begin to look, on the loop of the bridge."""
        self._ros.attach(loop)
        first = loop.now() + self._phase

        def look(number: int) -> None:
            for each in self.held:
                each.look()
            # From the first one, so that no rounding adds up.
            loop.call_at(first + (number + 1) * self._period, lambda: look(number + 1))

        loop.call_at(first, lambda: look(0))

    def publisher(self, ros_type: Any, topic: Any, greet: Any = None) -> _HeldPublisher:
        """Return a publisher that publishes the newest message at each look."""
        publisher = self._ros.publisher(ros_type, topic, greet)
        held = Held(publisher.publish)
        self.held.append(held)
        return _HeldPublisher(publisher, held)

    def subscribe(self, ros_type: Any, topic: Any, take: Callable[[bytes, int], None]) -> Any:
        """Subscribe; the newest message is taken at each look."""
        held = Held(take)
        self.held.append(held)
        return self._ros.subscribe(ros_type, topic, held.put)
