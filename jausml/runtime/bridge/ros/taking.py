"""Takes serialized messages of a topic and counts what was lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import time_ns
from typing import Any

from ...base.standstill import Standstill, steady
from ..ends.ros_side import Feed
from ..ends.topics import TopicCounts
from ..fastpath.side import FastSubscriber

AT_ONCE = 16
"""Messages of a topic that are taken in one turn of the loop, so that others have theirs."""

_NOT_TOLD = -1  # stands for the next number of a middleware that does not number messages

_KEPT_BY_ALL = 5000
"""Messages that a subscription with the history `keep_all` is taken to have kept."""


@dataclass(frozen=True)
class Subscription:
    """A subscription and what takes its messages."""

    handle: Any
    matched: Any
    message_class: type[Any]
    depth: int  # messages that it keeps; 0 means all
    # Is given each serialized message, and the time in nanoseconds at which it was published, by
    # the clock of its publisher.
    take: Callable[[bytes, int], None]
    age_limit: int  # nanoseconds after which a message that waits is too old; 0 means never
    counts: TopicCounts


def reader(  # noqa: C901 - for two functions that share the number expected
    subscription: Subscription,
    announced: Callable[[], int],
    standstill: Standstill,
    rearm: Callable[[int], object] | None = None,
    descriptor: int = -1,
) -> Callable[[], None]:
    """Returns what takes the messages that wait, a limited number at once.

    One function does all that happens to each message between ROS and `take`: each further one
    would show in the latency.

    Args:
        announced: Returns how many messages to take.
        rearm: Asks for another call for so many messages. None means that `announced` is no more
            than a guess: the middleware tells by itself when more is there, and not how much.
        descriptor: Where it is announced, from which a core may take the usual messages.
    """
    handle, kind, take, counts = (
        subscription.handle,
        subscription.message_class,
        subscription.take,
        subscription.counts,
    )
    take_message = handle.take_message
    follow = _Publishers(subscription).follow
    age_limit = subscription.age_limit or time_ns()
    expected: int = 0

    def read() -> None:
        nonlocal expected
        if steady() > standstill.due:
            standstill.end()
        left = announced()
        rest = left - AT_ONCE if left > AT_ONCE else 0
        oldest = time_ns() - age_limit
        try:
            while left > rest:
                left -= 1
                taken = take_message(kind, True)  # noqa: FBT003 - raw
                if taken is None:
                    # What was announced and is not there any more was overwritten.
                    if rearm is not None:
                        counts.lost += left + 1
                    left = 0
                    return
                data, info = taken
                counts.taken += 1
                if info["publication_sequence_number"] == expected:
                    expected += 1
                else:
                    expected = follow(expected, info["publication_sequence_number"])
                # Of 0, which stands for a time that nobody told, nothing is known.
                if 0 < info["received_timestamp"] < oldest:
                    counts.too_old += 1
                else:
                    take(data, info["source_timestamp"])
        finally:
            if left and rearm is not None:
                rearm(left)

    find = getattr(take, "fast_path", None)
    if rearm is None or find is None:
        return read
    feed = Feed(handle.pointer, descriptor, subscription.age_limit, counts)
    fast: FastSubscriber | None = None

    def read_other() -> None:
        """Takes what a core has not passed on, and looks whether it can from now on."""
        nonlocal expected, fast
        expected = feed.expected
        other = None if fast is None else fast.pending()
        if other is None:
            read()
        else:
            if steady() > standstill.due:
                standstill.end()
            counts.taken += 1
            usual = other.number == expected
            expected = expected + 1 if usual else follow(expected, other.number)
            if 0 < other.received < time_ns() - age_limit:
                counts.too_old += 1
            else:
                take(other.data, other.published)
            if other.left:
                rearm(other.left)
        feed.expected = expected
        if fast is None or not fast.is_current:
            fast = find(feed)
        else:
            fast.look()

    return read_other


class _Publishers:
    """The publishers of a topic, as far as they are to be known to tell what was missed.

    Each publisher numbers its messages, but nothing tells whose a message is. So a gap is one only
    while there is a single publisher, and no message of a former one can still have waited.
    """

    def __init__(self, subscription: Subscription) -> None:
        self._counts = subscription.counts
        self._waiting = subscription.depth or _KEPT_BY_ALL
        self._trusted_from = 0
        self._matched = subscription.matched

    def follow(self, expected: int, number: int | None) -> int:
        """Returns the number after one that was not expected; counts what is missed for certain."""
        if number is None:
            return _NOT_TOLD
        # The state may be read at any time, and a publisher is found before its messages come.
        state = self._matched.take_event()
        counts = self._counts
        if state.current_count_change or state.total_count_change:
            former = state.total_count - state.total_count_change
            self._trusted_from = counts.taken + (self._waiting if former else 0)
        elif expected < number and state.current_count == 1 and counts.taken > self._trusted_from:
            counts.missed += number - expected
        return number + 1
