"""Waits for ROS on a thread with a wait set of its own, where the middleware has no listeners."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from .ros_internals import internals
from .ros_taking import AT_ONCE, reader

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.loop import Loop
    from .ros_taking import Subscription

    _Served = tuple[tuple[Any, Callable[[], object]], ...]


class WaitSet:
    """Serves topics and events on a thread, with the lock of the loop."""

    def __init__(self, loop: Loop, context: Any) -> None:
        """Waits for nothing yet.

        Args:
            loop: The loop whose lock is held while something is served.
            context: The context of rclpy.
        """
        self._loop = loop
        self._context = context
        with context.handle:
            self._wake_up = internals.GuardCondition(context.handle)
        self._subscriptions: list[tuple[Any, Callable[[], object]]] = []
        self._events: list[tuple[Any, Callable[[], object]]] = []
        self._thread: threading.Thread | None = None
        self._is_closing = False

    def subscription(self, subscription: Subscription) -> None:
        """Takes the messages of a subscription, what waits already included."""
        self._subscriptions.append((subscription.handle, reader(subscription, lambda: AT_ONCE)))
        self._wake_up.trigger_guard_condition()

    def event(self, event: Any, read: Callable[[], object]) -> None:
        """Runs `read` when an event has something to tell."""
        self._events.append((event, read))
        self._wake_up.trigger_guard_condition()

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Begins to wait.

        Args:
            fail: Told on the thread why nobody waits any more, unless this was closed.
        """
        self._thread = threading.Thread(
            target=self._run, args=[fail], name="ros-wait-set", daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """Ends the thread; the handles may be destroyed then."""
        self._is_closing = True
        self._wake_up.trigger_guard_condition()
        if self._thread is not None:
            self._thread.join()
        self._wake_up.destroy_when_not_in_use()
        self._subscriptions.clear()
        self._events.clear()

    def _run(self, fail: Callable[[BaseException], None]) -> None:
        try:
            while not self._is_closing:
                self._wait_for_changes()
        except BaseException as error:
            if not self._is_closing:
                fail(error)

    def _wait_for_changes(self) -> None:
        """Waits with one wait set until something is added to it."""
        subscriptions, events = tuple(self._subscriptions), tuple(self._events)
        with self._context.handle:
            wait_set = internals.WaitSet(
                len(subscriptions), 1, 0, 0, 0, len(events), self._context.handle
            )
        try:
            self._serve_all(wait_set, subscriptions, events)
        finally:
            wait_set.destroy_when_not_in_use()

    def _serve_all(self, wait_set: Any, subscriptions: _Served, events: _Served) -> None:
        readers = {handle.pointer: read for handle, read in subscriptions}
        while (
            not self._is_closing
            and len(subscriptions) == len(self._subscriptions)
            and len(events) == len(self._events)
        ):
            # rcl forgets what was not ready: all has to be named again.
            wait_set.clear_entities()
            wait_set.add_guard_condition(self._wake_up)
            for handle, _ in subscriptions:
                wait_set.add_subscription(handle)
            for handle, _ in events:
                wait_set.add_event(handle)
            wait_set.wait(-1)
            ready = [readers[each] for each in wait_set.get_ready_entities("subscription")]
            ready += [
                read for index, (_, read) in enumerate(events) if wait_set.is_ready("event", index)
            ]
            self._serve(ready)

    def _serve(self, ready: list[Callable[[], object]]) -> None:
        with self._loop.lock:
            if self._is_closing:
                return
            for read in ready:
                try:
                    read()
                except Exception as error:
                    self._loop.counters.count("loop.callback_failed", repr(error), error=error)
