"""Latency of a connection, measured while somebody wants to know it."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from ...conversions import ConversionError, Time, timestamp_to_time

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...wire.message import Message
    from .diagnostics import Statistics

    Take = Callable[[bytes, Any], None]
    Age = Callable[[bytes, Any], "int | None"]

WINDOW = 1000
"""Latest messages of which percentiles are told."""


class Latency:
    """Ages and handling times of the latest messages.

    A message's age is the time from the stamp of its source to the bridge, by the clocks of both
    computers; its handling time is that from when the bridge takes it until the target side has it.
    """

    def __init__(self, age: Age, clock: Callable[[], float]) -> None:
        """Has measured nothing yet.

        Args:
            age: Returns the age in nanoseconds of a message that arrives now, of its bytes and
                its origin; None when its source states no time.
        """
        self._clock = clock
        self._age = age
        self._ages: deque[int] = deque(maxlen=WINDOW)
        self._handling: deque[int] = deque(maxlen=WINDOW)

    def measuring(self, take: Take, counts: Statistics) -> Take:
        """Returns what takes messages as `take` does, and measures those that are passed on."""
        clock = self._clock
        note_age, note_handling, age_of = self._ages.append, self._handling.append, self._age

        def measured(data: bytes, origin: Any = None) -> None:
            begun, passed = clock(), counts.passed
            take(data, origin)
            handling = round((clock() - begun) * 1e9)
            if counts.passed > passed:
                note_handling(handling)
                age = age_of(data, origin)
                if age is not None:
                    note_age(age - handling)

        return measured

    def describe(self) -> list[tuple[str, str]]:
        """Names and values for diagnostics; none before the first message."""
        return [
            *_percentiles("source to bridge", self._ages),
            *_percentiles("in the bridge", self._handling),
        ]


def _percentiles(name: str, nanoseconds: Sequence[int]) -> list[tuple[str, str]]:
    ranked = sorted(nanoseconds)
    if not ranked:
        return []
    last = len(ranked) - 1
    shown = (("p50", last * 50 // 100), ("p99", last * 99 // 100), ("max", last))
    return [(f"{name} {word} (us)", f"{ranked[rank] / 1000:.1f}") for word, rank in shown]


def age_of_stamp(message: Message, now: int) -> int | None:
    """Returns the age of a JAUS message in nanoseconds; None if it has no TimeStamp.

    Args:
        now: Time of day in nanoseconds since 1970.
    """
    stamp = getattr(message, "time_stamp", None)
    if stamp is None:
        return None
    try:
        sent = timestamp_to_time(stamp, near=Time(*divmod(now, 10**9)))
    except ConversionError:
        return None
    return now - sent.sec * 10**9 - sent.nanosec


def age_of_time(nanoseconds: int, now: int) -> int | None:
    """Returns the age of a ROS message in nanoseconds; None if it has no stamp.

    Args:
        nanoseconds: When its publisher has sent it, since 1970.
        now: Time of day in nanoseconds since 1970.
    """
    return now - nanoseconds if nanoseconds else None
