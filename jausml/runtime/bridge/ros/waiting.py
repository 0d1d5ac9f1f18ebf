"""Waiting for ROS: by listeners on the epoll of the loop, or by wait sets on threads."""

from __future__ import annotations

import ctypes
import os
import platform
import sys
import threading
from collections.abc import Callable, Iterable
from functools import partial
from itertools import compress
from typing import Any, Literal

from ...base.loop import Loop
from .internals import internals
from .taking import AT_ONCE, Subscription, reader

Read = Callable[[], object]  # takes the messages of a topic, or the state of an event


class WaitSets:
    """Serves topics and events on threads, with the lock of the loop.

    Each wait has to name all handles of the set again, so it takes longer with each topic. Events
    have a set of their own: they are as many as topics, and may be late.
    """

    def __init__(self, loop: Loop, context: Any) -> None:
        self._standstill = loop.standstill
        self._topics = _ServedSet(loop, context, "subscription")
        self._events = _ServedSet(loop, context, "event")

    def subscription(self, subscription: Subscription) -> None:
        """Takes the messages of a subscription, waiting ones included."""
        read = reader(subscription, lambda: AT_ONCE, self._standstill)
        self._topics.add(subscription.handle, read)

    def event(self, event: Any, read: Read) -> None:
        """Runs `read` for each change of an event."""
        self._events.add(event, read)

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Starts the threads; `fail` is called on one that ends before `close`, with its error."""
        self._topics.start(fail)
        self._events.start(fail)

    def close(self) -> None:
        """Ends the threads; the handles may be destroyed then."""
        self._topics.close()
        self._events.close()


class _ServedSet:
    """A wait set, made anew for each new handle, and the thread that waits with it."""

    def __init__(self, loop: Loop, context: Any, kind: Literal["subscription", "event"]) -> None:
        self._loop = loop
        self._context = context
        self._kind = kind
        with context.handle:
            self._wake_up = internals.GuardCondition(context.handle)
        self._served: list[tuple[Any, Read]] = []
        self._thread: threading.Thread | None = None
        self._is_closing = False

    def add(self, handle: Any, read: Read) -> None:
        """Adds a handle of a subscription or an event."""
        self._served.append((handle, read))
        self._wake_up.trigger_guard_condition()

    def start(self, fail: Callable[[BaseException], None]) -> None:
        name = "ros-topics" if self._kind == "subscription" else "ros-events"
        self._thread = threading.Thread(target=self._run, args=[fail], name=name, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._is_closing = True
        self._wake_up.trigger_guard_condition()
        if self._thread is not None:
            self._thread.join()
        self._wake_up.destroy_when_not_in_use()
        self._served.clear()

    def _run(self, fail: Callable[[BaseException], None]) -> None:
        try:
            while not self._is_closing:
                self._wait_until_more(tuple(self._served))
        except BaseException as error:
            if not self._is_closing:
                fail(error)

    def _wait_until_more(self, served: tuple[tuple[Any, Read], ...]) -> None:
        """Serves handles with one wait set until there is a new one."""
        has_topics, count = self._kind == "subscription", len(served)
        with self._context.handle:
            counts = (count, 1, 0, 0, 0, 0) if has_topics else (0, 1, 0, 0, 0, count)
            wait_set = internals.WaitSet(*counts, self._context.handle)
        add = wait_set.add_subscription if has_topics else wait_set.add_event
        handles, reads = zip(*served, strict=True) if served else ((), ())
        by_pointer = {handle.pointer: read for handle, read in served}
        try:
            while not self._is_closing and len(served) == len(self._served):
                # rcl removes handles that were not ready.
                wait_set.clear_entities()
                wait_set.add_guard_condition(self._wake_up)
                for handle in handles:
                    add(handle)
                wait_set.wait(-1)
                ready: Iterable[Read]
                if has_topics:
                    ready = map(by_pointer.__getitem__, wait_set.get_ready_entities(self._kind))
                else:
                    are_ready = [wait_set.is_ready(self._kind, index) for index in range(count)]
                    ready = compress(reads, are_ready)
                self._serve(tuple(ready))
        finally:
            wait_set.destroy_when_not_in_use()

    def _serve(self, ready: tuple[Read, ...]) -> None:
        with self._loop.lock:
            for read in ready if not self._is_closing else ():
                try:
                    read()
                except Exception as error:
                    self._loop.counters.count("loop.callback_failed", repr(error), error=error)


ON_MESSAGE = "rcl_subscription_set_on_new_message_callback"
ON_EVENT = "rcl_event_set_callback"

EVENTS_TOGETHER = 16  # events that share an eventfd, and are read together
_MACHINES = ("x86_64", "aarch64")


class NoListenerError(Exception):
    """The middleware cannot write to an eventfd here."""


class Listener:
    """Registers topics and events with the loop, which serves them like sockets.

    librcl calls a function for each new message or event, on a thread of the middleware:
    `callback(user_data, count)`. `eventfd_write(fd, value)` of libc has the same convention of
    calls where the first two integer arguments travel in registers, which holds for Linux on x86-64
    and AArch64. So that function itself is the callback, and the number of an eventfd its user
    data: no Python runs and no lock is taken until the loop wakes up.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._callback, self._on_message, self._on_event = _callback_and_setters()
        self._unset: list[Callable[[], int]] = []
        self._events: list[Read] = []
        self._events_number = -1
        self._reads: dict[int, Read] = {}
        self._is_started = False

    def try_out(self, subscription: Any, event: Any) -> None:
        """Sets both callbacks and removes them; raises NoListenerError if that fails."""
        number = _eventfd()
        try:
            for function, handle in ((self._on_message, subscription), (self._on_event, event)):
                self._listen(function, handle, number)
        finally:
            self._unset_all()
            os.close(number)

    def subscription(self, subscription: Subscription) -> None:
        """Takes the messages of a subscription on the loop, waiting ones included."""
        number = _eventfd()
        read = reader(
            subscription,
            partial(os.eventfd_read, number),
            self._loop.standstill,
            partial(os.eventfd_write, number),
            number,
        )
        self._register(number, read)
        self._listen(self._on_message, subscription.handle, number)

    def event(self, event: Any, read: Read) -> None:
        """Runs `read` on the loop for each change of an event, and sometimes without.

        Several events share an eventfd: they are rare, and a process may have 1024 descriptors.
        """
        if len(self._events) % EVENTS_TOGETHER == 0:
            self._events = []
            self._events_number = _eventfd()
            read_all = partial(self._read_events, self._events_number, self._events)
            self._register(self._events_number, read_all)
        self._events.append(read)
        self._listen(self._on_event, event, self._events_number)

    def start(self, fail: Callable[[BaseException], None]) -> None:  # noqa: ARG002
        """Begins to serve; the loop counts errors of callbacks."""
        self._is_started = True
        with self._loop.lock:
            for number, read in self._reads.items():
                self._loop.register(number, read)

    def close(self) -> None:
        """Stops serving; the handles may be destroyed then."""
        with self._loop.lock:
            for number in self._reads:
                self._loop.unregister(number)
        # Callbacks first, as the number of a closed descriptor may soon be used again.
        self._unset_all()
        for number in self._reads:
            os.close(number)
        self._reads.clear()

    def _unset_all(self) -> None:
        for unset in self._unset:
            unset()
        self._unset.clear()

    def _listen(self, function: Any, handle: Any, number: int) -> None:
        """Makes the middleware write to an eventfd for a handle."""
        code = function(handle.pointer, self._callback, number)
        if code != 0:
            raise NoListenerError(f"{function.__name__} gives {code}")
        self._unset.append(partial(function, handle.pointer, None, None))

    def _register(self, number: int, read: Read) -> None:
        self._reads[number] = read
        if self._is_started:
            self._loop.register(number, read)

    def _read_events(self, number: int, events: list[Read]) -> None:
        os.eventfd_read(number)
        for read in events:
            try:
                read()
            except Exception as error:
                self._loop.counters.count("loop.callback_failed", repr(error), error=error)


def _eventfd() -> int:
    return os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)


def _callback_and_setters() -> tuple[ctypes.c_void_p, Any, Any]:
    """Returns the callback, and the functions that set it for messages and for events."""
    if sys.platform != "linux" or platform.machine() not in _MACHINES:
        raise NoListenerError(f"not tried on {sys.platform} {platform.machine()}")
    try:
        # The copy that rclpy has loaded, which has its state.
        rcl = ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
        write = ctypes.cast(ctypes.CDLL(None).eventfd_write, ctypes.c_void_p)
        setters = [getattr(rcl, name) for name in (ON_MESSAGE, ON_EVENT)]
    except (OSError, AttributeError) as error:
        raise NoListenerError(str(error)) from error
    for function in setters:
        function.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
        function.restype = ctypes.c_int
    return write, setters[0], setters[1]
