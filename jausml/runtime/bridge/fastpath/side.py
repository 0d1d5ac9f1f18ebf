"""Fast path of one bridge: while its loop waits, the compiled core passes messages on.

The core takes the messages that need no Python, and leaves the others. What it has done is settled,
that is brought into the state and the counts of Python, when the next turn of the loop begins.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from functools import partial
from select import EPOLLIN

from ...base.fast_path import FastSending
from ...base.standstill import steady
from ...component.base import Component
from ...transports.udp.judp import JudpTransport
from ..ends.ros_side import Feed, ReturnedMessage
from .library import (
    NONE,
    SENT,
    SEVERAL,
    Destination,
    Library,
    NoFastPathError,
    Subscription,
    Waited,
    packed_host,
)
from .receiving import FastReceiver

_NO_NUMBER = (1 << 64) - 1  # number of a message of a middleware that does not number them
_FOREVER = -1.0  # seconds of a wait without a limit


class SharedNumbers:
    """Iterator of sequence numbers in memory that Python and the core share."""

    def __init__(self, library: Library, first: int) -> None:
        self.cell = ctypes.c_uint64(first)
        self._next = partial(library.next_number, ctypes.byref(self.cell))

    def __iter__(self) -> Iterator[int]:
        return self

    def __next__(self) -> int:
        number: int = self._next()
        return number

    def __repr__(self) -> str:
        # The packetizer reads the number of used numbers from it, as from itertools.count.
        return f"count({self.cell.value})"


class FastSubscriber:
    """Lets the core take the messages of one subscription, translate and send them."""

    def __init__(
        self, library: Library, core: int, feed: Feed, path: FastSending, index: int
    ) -> None:
        """Begins; raises LookupError where the core cannot send the messages now."""
        self.is_current = True  # whether the core still takes messages
        self._path, self._feed = path, feed
        outlet = path.outlet
        numbers, place = outlet.numbers, outlet.endpoint()
        # The core cannot count numbers that were begun before it was loaded.
        if not isinstance(numbers, SharedNumbers) or place is None:
            raise LookupError
        sock, (host, port), heard = place
        # Kept, as the core holds pointers into this and the following structure.
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
        pointer = library.core_subscribe(core, ctypes.byref(self._shared))
        if not pointer:
            raise LookupError
        self._pending = pointer.contents

    def settle(
        self, arrival: float, published: int, unknown: int, datagrams: int, error: int
    ) -> None:
        """Counts a message that the core has sent; see `SENT`."""
        self._feed.counts.taken += 1
        self._path.outlet.sent(datagrams, error)
        self._path.passed(arrival, published, unknown)

    def settle_numbers(self) -> None:
        """Takes over the expected number of the next message, and how many were lost."""
        shared, feed = self._shared, self._feed
        feed.expected = shared.expected
        feed.counts.lost += shared.lost
        # Taken over once: the core counts from 0 again.
        shared.lost = 0

    def pending(self) -> ReturnedMessage | None:
        """Returns the message that the core has taken and left to Python; None without one."""
        message = self._pending
        if not self.is_current or not message.data:
            return None
        data, number = ctypes.string_at(message.data, message.size), message.number
        # Once: the core fills it with the next message that it leaves.
        message.data = None
        return ReturnedMessage(
            data,
            None if number == _NO_NUMBER else number,
            message.received,
            message.published,
            message.left,
        )

    def update(self) -> None:
        """Gives the core the expected number, and when the destination was last heard."""
        place = self._path.outlet.endpoint()
        # An unknown number is -1 in Python, and all bits in the core.
        self._shared.expected = self._feed.expected & _NO_NUMBER
        if place is not None:
            _sock, _endpoint, self._to.heard = place


class FastSide:
    """Lets the compiled core wait for the loop of a bridge, and pass messages on meanwhile.

    Raises:
        NoFastPathError: The network or the clock is not that of the system, or memory is lacking.
    """

    def __init__(self, code: ctypes.CDLL, component: Component) -> None:
        transport, self._loop = component.transport, component.loop
        # The core reads real sockets by the real clock; a virtual world has neither.
        if not isinstance(transport, JudpTransport) or self._loop.now is not steady:
            raise NoFastPathError("the network or the clock is not that of the system")
        self._library = library = Library(code)
        self._core = library.core(library.ros, self._loop.descriptor)
        if self._core is None:
            raise NoFastPathError("there is no memory")
        self._transport = transport
        self._revision = -1
        # One structure for all waits, as it is large.
        self._waited = Waited()
        self._waited_pointer = ctypes.pointer(self._waited)
        self._has_passed = False
        self._subscribers: list[FastSubscriber] = []
        self._receiver = FastReceiver(library, self._core, transport, component)
        # Before the first sender is made, which would count in Python.
        transport.count_by(partial(SharedNumbers, library))
        with self._loop.lock:
            transport.receive_by(self._receiver.receiver)
            self._loop.revision.stop_by(partial(library.core_stop, self._core))
            self._loop.wait_by(self._wait, self._settle)

    def __del__(self) -> None:
        """Frees the core. Not in `close`, during which the loop may still wait in the core."""
        if getattr(self, "_core", None) is not None:
            self._library.core_end(self._core)

    def subscriber(self, feed: Feed, path: FastSending) -> FastSubscriber | None:
        """Returns the taker of a subscription; None where the core cannot send its messages now."""
        if self._revision != self._loop.revision.number:
            return None  # the core forgets all subscriptions before it waits again
        index = len(self._subscribers)
        try:
            subscriber = FastSubscriber(self._library, self._core, feed, path, index)
        except LookupError:
            return None
        self._subscribers.append(subscriber)
        return subscriber

    def close(self) -> None:
        """Lets Python wait and receive again."""
        with self._loop.lock:
            # Stops the core before anything that it uses is freed.
            self._loop.revision.changed()
            self._loop.revision.stop_by(None)
            self._loop.wait_by(None, None)
            # The loop may still wait in the core, or for the lock, and will not settle this wait.
            self._settle_wait()
            self._end_subscribers()
            self._transport.receive_by(None)

    def _end_subscribers(self) -> None:
        for subscriber in self._subscribers:
            subscriber.is_current = False
        self._subscribers.clear()

    def _wait(self, seconds: float | None, _most: int) -> list[tuple[int, int]]:
        """Waits and returns like `epoll.poll`, while the core passes messages on."""
        library, receiver = self._library, self._receiver
        self._has_passed = False
        if receiver.has_left_datagrams:  # to be received before newer ones
            return [(receiver.descriptor, EPOLLIN)]
        # Before the revision is read: each later change of it stops the core again.
        library.core_start(self._core)
        if (number := self._loop.revision.number) != self._revision:
            library.core_forget(self._core)
            receiver.forget()
            self._end_subscribers()
            self._revision = number
        due = self._loop.standstill.due
        wait = _FOREVER if seconds is None else seconds
        only = library.core_wait(self._core, wait, due, self._waited_pointer)
        # A single ready descriptor is the result itself, so that no memory has to be read.
        if only != SEVERAL:
            return [] if only == NONE else [(only, EPOLLIN)]
        self._has_passed, waited = True, self._waited
        ready = set(waited.ready[: waited.ready_count])
        # Datagrams of the core are received with the socket, which may not be ready itself.
        if waited.left_count:
            ready.add(receiver.descriptor)
        return [(descriptor, EPOLLIN) for descriptor in ready]

    def _settle(self) -> None:
        if self._has_passed:
            self._settle_wait()

    def _settle_wait(self) -> None:
        """Settles the messages of the last wait, once."""
        waited = self._waited
        if waited.taken_count or waited.left_count:
            self._receiver.settle(waited)
        if waited.sent_count:
            for position in range(waited.sent_count):
                arrival, published, unknown, index, datagrams, error = SENT.unpack_from(
                    waited.sent, position * SENT.size
                )
                subscriber = self._subscribers[index]
                subscriber.settle(arrival, published, unknown, datagrams, error)
                subscriber.settle_numbers()
        waited.taken_count = waited.left_count = waited.sent_count = 0
