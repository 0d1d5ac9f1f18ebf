"""A part of a recording, by the times in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

_NANO = 10**9
T = TypeVar("T")


@dataclass(frozen=True)
class Span:
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


WHOLE = Span()
"""All of a recording."""
