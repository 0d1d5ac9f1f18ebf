"""Work of actions on the executor of rclpy, and the goals that are under way."""

from __future__ import annotations

import threading
import time
from collections import deque
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.loop import Loop
    from ...guardian.ward import Ward


class ActionWork:
    """What the actions of one node have done, in order, and the goals that are under way."""

    def __init__(self, node: Any, executor: Any, loop: Loop, ward: Ward | None) -> None:
        self.loop = loop
        self.ward = ward
        self.node = node
        self._executor = executor
        self._waiting: deque[Callable[[], object]] = deque()
        self._open: set[object] = set()
        self._changed = threading.Condition()

    def run(self, callback: Callable[..., object], *arguments: object) -> None:
        """Runs a callback on the thread of the executor, after those asked for earlier.

        The executor begins with the task that it got last, so the order is kept here.
        """
        self._waiting.append(partial(callback, *arguments))
        self._executor.create_task(self._run_next)

    def _run_next(self) -> None:
        self.guarded(self._waiting.popleft())

    def guarded(self, callback: Callable[..., object], *arguments: object) -> None:
        """Runs a callback; an error is counted, for it would end the executor."""
        try:
            callback(*arguments)
        except Exception as error:
            self.loop.counters.count("ros_actions.failed", repr(error), error=error)

    def opened(self, goal: object) -> None:
        """Notes a goal that is under way."""
        with self._changed:
            self._open.add(goal)

    def closed(self, goal: object) -> None:
        """Notes a goal that has ended."""
        with self._changed:
            self._open.discard(goal)
            self._changed.notify_all()

    def wait(self, deadline: float) -> None:
        """Waits until all goals have ended, but not longer than to a time of the steady clock."""
        with self._changed:
            while self._open and (left := deadline - time.monotonic()) > 0:
                self._changed.wait(left)
