"""Fast path of one bridge: while its loop waits, the compiled core passes messages on by itself.

A message is usual where the core can do that. Any other is left to Python, and what the core has
done is written down ("settled") when the next turn of the loop begins.
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
from ..ends.ros_side import Feed, Other
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

_NOT_TOLD = (1 << 64) - 1
"""Stands for the number of a message where a middleware does not number them."""

_FOREVER = -1.0
"""Seconds for which the core waits without a limit."""


class SharedNumbers:
    """Sequence numbers that Python and a core count together."""

    def __init__(self, library: Library, first: int) -> None:
        self.cell = ctypes.c_uint64(first)
        self._next = partial(library.next_number, ctypes.byref(self.cell))

    def __iter__(self) -> Iterator[int]:
        return self

    def __next__(self) -> int:
        number: int = self._next()
        return number

    def __repr__(self) -> str:
        # The packetizer reads from it how many numbers are taken.
        return f"count({self.cell.value})"


class FastSubscriber:
    """Has a core take the messages of one subscription, and send what they become."""

    def __init__(
        self, library: Library, core: int, feed: Feed, path: FastSending, index: int
    ) -> None:
        """Begins; raises LookupError where the messages cannot go out alone now."""
        self.is_current = True  # whether the core still does
        self._path, self._feed = path, feed
        outlet = path.outlet
        numbers, place = outlet.numbers, outlet.endpoint()
        # Numbers that were begun before the core was there are counted by Python alone.
        if not isinstance(numbers, SharedNumbers) or place is None:
            raise LookupError
        sock, (host, port), heard = place
        # Kept, like what follows: the core holds pointers into it.
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
        # Told once: the core counts on from 0.
        shared.lost = 0

    def pending(self) -> Other | None:
        """Returns the message that the core has taken and left to Python; None without one."""
        message = self._pending
        if not self.is_current or not message.data:
            return None
        data, number = ctypes.string_at(message.data, message.size), message.number
        # Once: the core fills it again with the next message that is not usual.
        message.data = None
        message_number = None if number == _NOT_TOLD else number
        return Other(data, message_number, message.received, message.published, message.left)

    def look(self) -> None:
        """Tells the core which message is next, and when the destination was heard."""
        place = self._path.outlet.endpoint()
        # What nobody has told is -1 in Python, and all bits in the core.
        self._shared.expected = self._feed.expected & _NOT_TOLD
        if place is not None:
            _sock, _endpoint, self._to.heard = place


class FastSide:
    """Has the compiled core wait for the loop of a bridge, and pass usual messages meanwhile.

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
        # One for all waits: it is large, and its address is handed over with each call.
        self._waited = Waited()
        self._waited_pointer = ctypes.pointer(self._waited)
        self._has_passed = False
        self._subscribers: list[FastSubscriber] = []
        self._receiver = FastReceiver(library, self._core, transport, component)
        # Before there is any sender, which would count by itself.
        transport.count_by(partial(SharedNumbers, library))
        with self._loop.lock:
            transport.receive_by(self._receiver.receiver)
            self._loop.revision.stop_by(partial(library.core_stop, self._core))
            self._loop.wait_by(self._wait, self._settle)

    def __del__(self) -> None:
        """Ends the core when nobody waits with it any more."""
        # Not in `close`: the loop may wait in the core, without the lock, while that runs.
        if getattr(self, "_core", None) is not None:
            self._library.core_end(self._core)

    def subscriber(self, feed: Feed, path: FastSending) -> FastSubscriber | None:
        """Returns what takes the messages of a subscription; None where they cannot go alone."""
        if self._revision != self._loop.revision.number:
            return None  # the core forgets all before it waits again
        index = len(self._subscribers)
        try:
            subscriber = FastSubscriber(self._library, self._core, feed, path, index)
        except LookupError:
            return None
        self._subscribers.append(subscriber)
        return subscriber

    def close(self) -> None:
        """Has Python wait and receive again."""
        with self._loop.lock:
            # Stops the core before anything that it uses is taken back.
            self._loop.revision.changed()
            self._loop.revision.stop_by(None)
            self._loop.wait_by(None, None)
            # The loop may still wait in the core, or for the lock, and would not settle it.
            self._write_down()
            self._end_subscribers()
            self._transport.receive_by(None)

    def _end_subscribers(self) -> None:
        for subscriber in self._subscribers:
            subscriber.is_current = False
        self._subscribers.clear()

    def _wait(self, seconds: float | None, _most: int) -> list[tuple[int, int]]:
        """Waits as `epoll.poll` does, and returns what it does, while usual messages pass."""
        library, receiver = self._library, self._receiver
        self._has_passed = False
        if receiver.has_left_datagrams:  # what comes behind them must not pass before them
            return [(receiver.descriptor, EPOLLIN)]
        # Opened before the revision is read: whoever changes it from here on stops the core again.
        library.core_start(self._core)
        if (number := self._loop.revision.number) != self._revision:
            library.core_forget(self._core)
            receiver.forget()
            self._end_subscribers()
            self._revision = number
        due = self._loop.standstill.due
        wait = _FOREVER if seconds is None else seconds
        only = library.core_wait(self._core, wait, due, self._waited_pointer)
        # The usual wake-up is one descriptor, told by the result alone: no memory is read for it.
        if only != SEVERAL:
            return [] if only == NONE else [(only, EPOLLIN)]
        self._has_passed, waited = True, self._waited
        ready = set(waited.ready[: waited.ready_count])
        # Left datagrams are read by whoever reads the socket, which need not be ready itself.
        if waited.left_count:
            ready.add(receiver.descriptor)
        return [(descriptor, EPOLLIN) for descriptor in ready]

    def _settle(self) -> None:
        if self._has_passed:
            self._write_down()

    def _write_down(self) -> None:
        """Writes down, once, what the last wait has passed and left."""
        waited = self._waited
        if waited.taken_count or waited.left_count:
            self._receiver.settle(waited)
        if waited.sent_count:
            senders = self._subscribers
            for at in range(waited.sent_count):
                when, published, unknown, index, datagrams, error = SENT.unpack_from(
                    waited.sent, at * SENT.size
                )
                senders[index].settle(when, published, unknown, datagrams, error)
                senders[index].settle_numbers()
        waited.taken_count = waited.left_count = waited.sent_count = 0
