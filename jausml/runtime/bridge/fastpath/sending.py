"""Messages of ROS to datagrams: a core takes, translates and sends the usual ones alone."""

from __future__ import annotations

import ctypes
from functools import partial
from typing import TYPE_CHECKING

from .library import SENT, Destination, Shipped, packed_host

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...base.fast_path import FastSending
    from .library import Library


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
    """Takes the messages of one subscription and sends what they become."""

    def __init__(self, library: Library, subscription: int, path: FastSending) -> None:
        """Prepares the core.

        Args:
            subscription: Address of the subscription of the client library.

        Raises:
            LookupError: The messages cannot go out alone now.
        """
        self._library, self._path = library, path
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
        self._core = library.subscriber(
            library.ros, subscription, ctypes.byref(path.translation), ctypes.byref(self._to)
        )
        self._out = Shipped()
        self._take = partial(library.take, self._core)
        self._where = ctypes.byref(self._out)

    def __del__(self) -> None:
        """Ends the core's part."""
        if getattr(self, "_core", None) is not None:
            self._library.subscriber_end(self._core)

    def take(self, wanted: int, expected: int, oldest: int) -> tuple[int, int]:
        """Takes messages; returns how many were sent, and why no more were.

        Args:
            expected: Number of the next message of the publisher.
            oldest: When one was received that is too old, in nanoseconds since 1970.
        """
        out, sent = self._out, self._path.outlet.sent
        left = self._take(wanted, expected, oldest, self._where)
        for at in range(out.count):
            when, published, unknown, datagrams, error = SENT.unpack_from(out.sent, at * SENT.size)
            sent(datagrams, error)
            self._path.passed(when, published, unknown)
        return out.count, left

    def other(self) -> tuple[bytes, int | None, int, int]:
        """Returns the message that is not usual: its bytes, number, when received and published."""
        out = self._out
        number = None if out.number == _NOT_TOLD else out.number
        return ctypes.string_at(out.data, out.size), number, out.received, out.published

    def look(self) -> None:
        """Learns when the component was heard, after Python has sent to it."""
        place = self._path.outlet.endpoint()
        if place is not None:
            self._to.heard = place[2]
