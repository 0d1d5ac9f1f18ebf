"""Waits for ROS with wait sets on threads of their own, where the middleware has no listeners.

Whoever waits with a wait set names all that it holds again in each round, so a round costs more
with each topic. Events have a set of their own for that reason: they are as many as topics, and
nothing is lost when one is late.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from .internals import internals
from .taking import AT_ONCE, reader

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ...base.loop import Loop
    from .taking import Subscription

    Read = Callable[[], object]


class WaitSets:
    """Serves topics and events on threads, with the lock of the loop."""

    def __init__(self, loop: Loop, context: Any) -> None:
        self._standstill = loop.standstill
        self._topics = _TopicSet(loop, context)
        self._events = _EventSet(loop, context)

    def subscription(self, subscription: Subscription) -> None:
        """Takes the messages of a subscription, what waits already included."""
        read = reader(subscription, lambda: AT_ONCE, self._standstill)
        self._topics.add(subscription.handle, read)

    def event(self, event: Any, read: Read) -> None:
        """Runs `read` when an event has something to tell."""
        self._events.add(event, read)

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Begins to wait.

        Args:
            fail: Told on a thread why nobody waits any more, unless this was closed.
        """
        self._topics.start(fail)
        self._events.start(fail)

    def close(self) -> None:
        """Ends the threads; the handles may be destroyed then."""
        self._topics.close()
        self._events.close()


class _ServedSet:
    """A wait set, built once for what it holds, and the thread that waits with it."""

    name: str

    def __init__(self, loop: Loop, context: Any) -> None:
        self._loop = loop
        self._context = context
        with context.handle:
            self._wake_up = internals.GuardCondition(context.handle)
        self._served: list[tuple[Any, Read]] = []
        self._thread: threading.Thread | None = None
        self._is_closing = False

    def add(self, handle: Any, read: Read) -> None:
        """Waits for one more, which is a subscription or an event."""
        self._served.append((handle, read))
        self._wake_up.trigger_guard_condition()

    def start(self, fail: Callable[[BaseException], None]) -> None:
        self._thread = threading.Thread(target=self._run, args=[fail], name=self.name, daemon=True)
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
        """Serves with one wait set until there is more to wait for."""
        wait_set = self._build(len(served))
        handles = [handle for handle, _ in served]
        reads = [read for _, read in served]
        by_pointer = {handle.pointer: read for handle, read in served}
        try:
            while not self._is_closing and len(served) == len(self._served):
                # rcl forgets what was not ready: all has to be named again.
                wait_set.clear_entities()
                wait_set.add_guard_condition(self._wake_up)
                self._fill(wait_set, handles)
                wait_set.wait(-1)
                self._serve(self._ready(wait_set, reads, by_pointer))
        finally:
            wait_set.destroy_when_not_in_use()

    def _serve(self, ready: list[Read]) -> None:
        with self._loop.lock:
            for read in ready if not self._is_closing else ():
                try:
                    read()
                except Exception as error:
                    self._loop.counters.count("loop.callback_failed", repr(error), error=error)

    def _build(self, count: int) -> Any:
        """Returns a wait set for so many, and for what wakes up."""
        raise NotImplementedError

    def _fill(self, wait_set: Any, handles: Iterable[Any]) -> None:
        """Names what to wait for."""
        raise NotImplementedError

    def _ready(self, wait_set: Any, reads: list[Read], by_pointer: dict[int, Read]) -> list[Read]:
        """Returns what is to be served, after the wait."""
        raise NotImplementedError


class _TopicSet(_ServedSet):
    name = "ros-topics"

    def _build(self, count: int) -> Any:
        with self._context.handle:
            return internals.WaitSet(count, 1, 0, 0, 0, 0, self._context.handle)

    def _fill(self, wait_set: Any, handles: Iterable[Any]) -> None:
        add = wait_set.add_subscription
        for handle in handles:
            add(handle)

    def _ready(self, wait_set: Any, reads: list[Read], by_pointer: dict[int, Read]) -> list[Read]:
        del reads
        return [by_pointer[each] for each in wait_set.get_ready_entities("subscription")]


class _EventSet(_ServedSet):
    name = "ros-events"

    def _build(self, count: int) -> Any:
        with self._context.handle:
            return internals.WaitSet(0, 1, 0, 0, 0, count, self._context.handle)

    def _fill(self, wait_set: Any, handles: Iterable[Any]) -> None:
        for handle in handles:
            wait_set.add_event(handle)

    def _ready(self, wait_set: Any, reads: list[Read], by_pointer: dict[int, Read]) -> list[Read]:
        del by_pointer
        return [read for index, read in enumerate(reads) if wait_set.is_ready("event", index)]
