"""Takes serialized messages of a subscription, and counts lost ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import time_ns
from typing import Any

from ...base.standstill import Standstill, steady
from ..ends.ros_side import Feed
from ..ends.topics import TopicCounts
from ..fastpath.side import FastSubscriber

AT_ONCE = 16  # messages of a topic that are taken in one turn of the loop, for the sake of others
_NO_NUMBER = -1  # expected number of a middleware that does not number messages
_KEPT_BY_ALL = 5000  # depth that is assumed for a subscription with the history `keep_all`


@dataclass(frozen=True)
class Subscription:
    """A subscription and the function that takes its messages."""

    handle: Any
    matched: Any  # event of publishers that come and go
    message_class: type[Any]
    depth: int  # messages that it keeps; 0 means all
    # Called with each serialized message, and the nanoseconds of its publication by the clock of
    # its publisher.
    take: Callable[[bytes, int], None]
    age_limit: int  # nanoseconds after which a message that waits is too old; 0 means never
    counts: TopicCounts


def reader(  # noqa: C901 - for two functions that share the number expected
    subscription: Subscription,
    count_waiting: Callable[[], int],
    standstill: Standstill,
    rearm: Callable[[int], object] | None = None,
    descriptor: int = -1,
) -> Callable[[], None]:
    """Returns a function that takes waiting messages, at most `AT_ONCE` in a call.

    It is a single function, as each further call would add to the latency of a message.

    Args:
        count_waiting: Returns the number of waiting messages.
        rearm: Requests another call for a number of messages. None if the middleware does so by
            itself, and `count_waiting` is only an upper bound.
        descriptor: The eventfd of the count, for the core.
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
        waiting = count_waiting()
        rest = waiting - AT_ONCE if waiting > AT_ONCE else 0
        oldest = time_ns() - age_limit
        try:
            while waiting > rest:
                waiting -= 1
                taken = take_message(kind, True)  # noqa: FBT003 - raw
                if taken is None:
                    # Messages that were counted and are not there were overwritten.
                    if rearm is not None:
                        counts.lost += waiting + 1
                    waiting = 0
                    return
                data, info = taken
                counts.taken += 1
                if info["publication_sequence_number"] == expected:
                    expected += 1
                else:
                    expected = follow(expected, info["publication_sequence_number"])
                # 0 stands for an unknown time.
                if 0 < info["received_timestamp"] < oldest:
                    counts.too_old += 1
                else:
                    take(data, info["source_timestamp"])
        finally:
            if waiting and rearm is not None:
                rearm(waiting)

    find = getattr(take, "fast_path", None)
    if rearm is None or find is None:
        return read
    feed = Feed(handle.pointer, descriptor, subscription.age_limit, counts)
    fast: FastSubscriber | None = None

    def read_returned() -> None:
        """Takes messages that the core leaves to Python, and updates or makes its taker."""
        nonlocal expected, fast
        expected = feed.expected
        message = None if fast is None else fast.pending()
        if message is None:
            read()
        else:
            if steady() > standstill.due:
                standstill.end()
            counts.taken += 1
            is_next = message.number == expected
            expected = expected + 1 if is_next else follow(expected, message.number)
            if 0 < message.received < time_ns() - age_limit:
                counts.too_old += 1
            else:
                take(message.data, message.published)
            if message.left:
                rearm(message.left)
        feed.expected = expected
        if fast is None or not fast.is_current:
            fast = find(feed)
        else:
            fast.update()

    return read_returned


class _Publishers:
    """Counts missed messages by the gaps between their numbers.

    Each publisher numbers its messages, but a message does not name its publisher. So a gap counts
    only while there is a single publisher, and no message of a former one can still be waiting.
    """

    def __init__(self, subscription: Subscription) -> None:
        self._counts = subscription.counts
        self._waiting = subscription.depth or _KEPT_BY_ALL
        self._trusted_from = 0
        self._matched = subscription.matched

    def follow(self, expected: int, number: int | None) -> int:
        """Returns the next expected number after an unexpected one; counts missed messages."""
        if number is None:
            return _NO_NUMBER
        # The state may be read at any time, and a publisher is found before its messages come.
        state = self._matched.take_event()
        counts = self._counts
        if state.current_count_change or state.total_count_change:
            former = state.total_count - state.total_count_change
            self._trusted_from = counts.taken + (self._waiting if former else 0)
        elif expected < number and state.current_count == 1 and counts.taken > self._trusted_from:
            counts.missed += number - expected
        return number + 1
