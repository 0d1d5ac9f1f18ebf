"""What of the traffic is recorded, and which part of a recording is read."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, TypeVar

from jausml.live.traffic.observing import ends_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from jausml.live.traffic.frames import Datagram

_NANO = 10**9
T = TypeVar("T")


@dataclass(frozen=True)
class TrafficFilter:
    """Patterns, in which `*` stands for anything; nothing selects all."""

    topics: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    components: tuple[str, ...] = ()

    def wants_topic(self, name: str) -> bool:
        """Whether a topic is recorded."""
        return _fits(name, self.topics or ("*",)) and not _fits(name, self.excluded)

    def wants(self, datagram: Datagram) -> bool:
        """Whether a datagram is recorded; one that cannot be read is."""
        if not self.components:
            return True
        ends = ends_of(datagram)
        return not ends or any(_fits(end, self.components) for end in ends)


def _fits(name: str, patterns: tuple[str, ...]) -> bool:
    return any(fnmatchcase(name, each) for each in patterns)


@dataclass(frozen=True)
class TimeSpan:
    """A part of a recording.

    Attributes:
        start: Seconds after the first message.
        duration: Seconds from there on, None to the end.
    """

    start: float = 0.0
    duration: float | None = None

    def of(self, found: Iterable[T], time_of: Callable[[T], int | None]) -> Iterator[T]:
        """Yields what is in it.

        Args:
            found: What was recorded, in the order of its times.
            time_of: The time of each in nanoseconds, None where nobody told: these are in it.
        """
        begin: int | None = None
        for each in found:
            time = time_of(each)
            if time is not None:
                begin = time if begin is None else begin
                since = (time - begin) / _NANO - self.start
                if self.duration is not None and since >= self.duration:
                    return
                if since < 0:
                    continue
            yield each

    def of_length(self, length: float) -> float:
        """Returns how many seconds of it there are in a recording of so many."""
        left = max(0.0, length - self.start)
        return left if self.duration is None else min(left, self.duration)


WHOLE = TimeSpan()
"""All of a recording."""
