"""Waits for ROS on the epoll of the loop: the middleware itself writes to an eventfd.

librcl calls a function for each new message or event, on a thread of the middleware:
`callback(user_data, count)`. `eventfd_write(fd, value)` of libc has the same convention of calls
where the first two integer arguments travel in registers, which holds for Linux on x86-64 and
AArch64. So that function itself is the callback, and the number of an eventfd its user data: no
Python runs and no lock is taken until the loop wakes up.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from functools import partial
from typing import TYPE_CHECKING, Any

from .taking import reader

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.loop import Loop
    from .taking import Subscription

ON_MESSAGE = "rcl_subscription_set_on_new_message_callback"
ON_EVENT = "rcl_event_set_callback"

EVENTS_TOGETHER = 16
"""Events that share an eventfd; all of them are read when one has something to tell."""

_MACHINES = ("x86_64", "aarch64")


class NoListenerError(Exception):
    """The middleware cannot write to an eventfd here."""


class Listener:
    """Registers topics and events with the loop; its callbacks run as those of sockets do."""

    def __init__(self, loop: Loop) -> None:
        """Finds the functions.

        Raises:
            NoListenerError: One of them is missing, or another machine calls them otherwise.
        """
        self._loop = loop
        self._callback, self._on_message, self._on_event = _functions()
        self._unset: list[Callable[[], int]] = []
        self._events: list[Callable[[], object]] = []
        self._events_number = -1
        self._ready: dict[int, Callable[[], object]] = {}
        self._is_started = False

    def try_out(self, subscription: Any, event: Any) -> None:
        """Tells whether the middleware takes the callbacks.

        Raises:
            NoListenerError: It does not, or rclpy gives no pointers.
        """
        number = _eventfd()
        try:
            for function, handle in ((self._on_message, subscription), (self._on_event, event)):
                self._listen(function, handle, number)
        finally:
            self._unset_all()
            os.close(number)

    def subscription(self, subscription: Subscription) -> None:
        """Takes the messages of a subscription on the loop, what waits already included."""
        number = _eventfd()
        read = reader(
            subscription,
            partial(os.eventfd_read, number),
            self._loop.standstill,
            partial(os.eventfd_write, number),
            number,
        )
        self._keep(number, read)
        self._listen(self._on_message, subscription.handle, number)

    def event(self, event: Any, read: Callable[[], object]) -> None:
        """Runs `read` on the loop when an event has something to tell, and now and then besides.

        Some events share an eventfd: they are rare, and a process may have 1024 descriptors.
        """
        if len(self._events) % EVENTS_TOGETHER == 0:
            self._events = []
            self._events_number = _eventfd()
            read_all = partial(self._read_events, self._events_number, self._events)
            self._keep(self._events_number, read_all)
        self._events.append(read)
        self._listen(self._on_event, event, self._events_number)

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Begins to serve what was registered so far.

        Args:
            fail: Not needed: what fails on the loop is counted there.
        """
        del fail
        self._is_started = True
        with self._loop.lock:
            for number, read in self._ready.items():
                self._loop.register(number, read)

    def close(self) -> None:
        """Serves nothing any more; the handles may be destroyed then."""
        with self._loop.lock:
            for number in self._ready:
                self._loop.unregister(number)
        # First the callbacks: a number that is closed may soon be that of something else.
        self._unset_all()
        for number in self._ready:
            os.close(number)
        self._ready.clear()

    def _unset_all(self) -> None:
        for unset in self._unset:
            unset()
        self._unset.clear()

    def _listen(self, function: Any, handle: Any, number: int) -> None:
        """Makes the middleware write to an eventfd."""
        code = function(handle.pointer, self._callback, number)
        if code != 0:
            raise NoListenerError(f"{function.__name__} gives {code}")
        self._unset.append(partial(function, handle.pointer, None, None))

    def _keep(self, number: int, read: Callable[[], object]) -> None:
        self._ready[number] = read
        if self._is_started:
            self._loop.register(number, read)

    def _read_events(self, number: int, events: list[Callable[[], object]]) -> None:
        os.eventfd_read(number)
        for read in events:
            try:
                read()
            except Exception as error:
                self._loop.counters.count("loop.callback_failed", repr(error), error=error)


def _eventfd() -> int:
    return os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)


def _functions() -> tuple[ctypes.c_void_p, Any, Any]:
    """Returns the callback, and what sets it for messages and for events."""
    if sys.platform != "linux" or platform.machine() not in _MACHINES:
        raise NoListenerError(f"not tried on {sys.platform} {platform.machine()}")
    try:
        # rclpy has loaded it; another copy of it would know nothing.
        rcl = ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
        write = ctypes.cast(ctypes.CDLL(None).eventfd_write, ctypes.c_void_p)
        setters = [getattr(rcl, name) for name in (ON_MESSAGE, ON_EVENT)]
    except (OSError, AttributeError) as error:
        raise NoListenerError(str(error)) from error
    for function in setters:
        function.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
        function.restype = ctypes.c_int
    return write, setters[0], setters[1]
