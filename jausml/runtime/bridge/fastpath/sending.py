"""Messages of ROS to datagrams: a core takes, translates and sends the usual ones alone."""

from __future__ import annotations

import ctypes
from functools import partial
from typing import TYPE_CHECKING, Protocol

from ..ends.ends import Other
from .library import Destination, Subscription, packed_host

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...base.fast_path import FastSending
    from ..ends.topics import TopicCounts
    from .library import Library


class Feed(Protocol):
    """A subscription, as who takes its messages tells of it.

    Attributes:
        address: Where the client library has it.
        descriptor: The eventfd that says how many messages wait.
        age_limit: Nanoseconds after which a message that waits is too old; 0 means never.
        expected: The number of the next message.
    """

    address: int
    descriptor: int
    age_limit: int
    expected: int
    counts: TopicCounts


_NOT_TOLD = (1 << 64) - 1
"""Stands for the number of a message where a middleware does not number them."""


class SharedNumbers:
    """Sequence numbers that Python and a core count together."""

    def __init__(self, library: Library, first: int) -> None:
        self.cell = ctypes.c_uint64(first)
        self._next = partial(library.next_number, ctypes.byref(self.cell))

    def __iter__(self) -> Iterator[int]:
        """Returns itself."""
        return self

    def __next__(self) -> int:
        """Returns the next number, in one call that no thread comes between."""
        number: int = self._next()
        return number

    def __repr__(self) -> str:
        """Returns what `itertools.count` says of where it is."""
        return f"count({self.cell.value})"


class FastSubscriber:
    """Has a core take the messages of one subscription, and send what they become.

    Attributes:
        is_current: Whether it still does.
    """

    def __init__(
        self, library: Library, core: int, feed: Feed, path: FastSending, index: int
    ) -> None:
        """Begins.

        Args:
            index: By which the core tells of what it has sent.

        Raises:
            LookupError: The messages cannot go out alone now.
        """
        self.is_current = True
        self._path, self._feed = path, feed
        outlet = path.outlet
        numbers, place = outlet.numbers, outlet.endpoint()
        if not isinstance(numbers, SharedNumbers) or place is None:
            raise LookupError
        sock, (host, port), heard = place
        self._to = Destination(
            host=packed_host(host),
            port=port,
            flags=outlet.priority,
            sock=sock,
            destination=outlet.destination,
            source=outlet.source,
            longest=outlet.longest,
            lifetime=outlet.lifetime,
            heard=heard,
            numbers=ctypes.pointer(numbers.cell),
        )
        self._shared = Subscription(
            handle=feed.address,
            translation=ctypes.pointer(path.translation),
            to=ctypes.pointer(self._to),
            descriptor=feed.descriptor,
            index=index,
            age_limit=feed.age_limit,
            expected=feed.expected,
        )
        found = library.core_subscribe(core, ctypes.byref(self._shared))
        if not found:
            raise LookupError
        self._pending = found.contents

    def settle(self, at: float, published: int, unknown: int, datagrams: int, error: int) -> None:
        """Writes down a message that was sent."""
        self._feed.counts.taken += 1
        self._path.outlet.sent(datagrams, error)
        self._path.passed(at, published, unknown)

    def settle_numbers(self) -> None:
        """Writes down which message is expected, and how many were lost."""
        shared, feed = self._shared, self._feed
        feed.expected = shared.expected
        feed.counts.lost += shared.lost
        shared.lost = 0

    def pending(self) -> Other | None:
        """Returns a message that is not usual, which was taken; None when there is none."""
        found = self._pending
        if not self.is_current or not found.data:
            return None
        data, number = ctypes.string_at(found.data, found.size), found.number
        found.data = None
        told = None if number == _NOT_TOLD else number
        return Other(data, told, found.received, found.published, found.left)

    def look(self) -> None:
        """Tells the core what Python has learnt when it took a message."""
        place = self._path.outlet.endpoint()
        self._shared.expected = self._feed.expected & _NOT_TOLD
        if place is not None:
            self._to.heard = place[2]
