"""The event loop: one thread that waits for sockets and deadlines."""

from __future__ import annotations

import contextlib
import heapq
import selectors
import socket
import threading
import time
from collections import deque
from typing import TYPE_CHECKING

from .counters import Clock, Counters

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

_COMPACT_FROM = 64


class Timer:
    """A callback that a loop runs at a time of its clock."""

    __slots__ = ("callback", "on_cancel", "order", "when")

    def __init__(
        self,
        when: float,
        order: int,
        callback: Callable[[], None],
        on_cancel: Callable[[], None],
    ) -> None:
        """Use ``Loop.call_at`` or ``Loop.call_later`` instead."""
        self.when = when
        self.order = order
        self.callback: Callable[[], None] | None = callback
        self.on_cancel: Callable[[], None] | None = on_cancel

    def cancel(self) -> None:
        """Keep the callback from running; no effect when it ran or was cancelled."""
        self.callback = None
        on_cancel, self.on_cancel = self.on_cancel, None
        if on_cancel is not None:
            on_cancel()

    def __lt__(self, other: Timer) -> bool:
        """Order by time, then by creation."""
        return (self.when, self.order) < (other.when, other.order)


class Loop:
    """Runs callbacks of sockets and timers on one thread, each while holding ``lock``.

    ``start`` gives the loop a thread of its own. Without it, ``run_once`` drives the loop from
    the caller's thread, with a clock of the caller's choice. All methods but ``run_once`` may be
    called from any thread. ``stop`` releases the descriptors of the loop and is final.
    """

    def __init__(self, clock: Clock = time.monotonic, counters: Counters | None = None) -> None:
        """Prepare a loop that does not run yet.

        Args:
            clock: Monotonic time in seconds.
            counters: Where failures are counted; the transport uses the same ones.
        """
        self.lock = threading.RLock()
        self.counters = Counters(clock) if counters is None else counters
        self._clock = clock
        self._selector = selectors.DefaultSelector()
        self._wake_receiver, self._wake_sender = socket.socketpair()
        self._wake_receiver.settimeout(0)
        self._wake_sender.settimeout(0)
        self._selector.register(self._wake_receiver, selectors.EVENT_READ, self._drain_wake_ups)
        self._state = threading.Lock()
        self._timers: list[Timer] = []
        self._created = 0
        self._cancelled = 0
        self._soon: deque[Callable[[], None]] = deque()
        self._woken = False
        self._thread: threading.Thread | None = None
        self._runner = 0
        self._stopping = False
        self._closed = False

    def __enter__(self) -> Loop:
        """Return the loop; it is stopped when the block ends."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Stop the loop."""
        self.stop()

    def now(self) -> float:
        """Return the time of the loop's clock in seconds."""
        return self._clock()

    def call_soon(self, callback: Callable[[], None]) -> None:
        """Run a callback in the next round of the loop, after those asked for earlier."""
        self._soon.append(callback)
        self._wake()

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Run a callback after a delay in seconds."""
        return self.call_at(self._clock() + delay_s, callback)

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Run a callback at a time of the loop's clock."""
        with self._state:
            self._created += 1
            timer = Timer(when, self._created, callback, self._timer_cancelled)
            heapq.heappush(self._timers, timer)
            is_earliest = self._timers[0] is timer
        if is_earliest:
            self._wake()
        return timer

    def register(self, sock: socket.socket, on_readable: Callable[[], None]) -> None:
        """Call ``on_readable`` whenever a socket has something to read."""
        with self._state:
            self._selector.register(sock, selectors.EVENT_READ, on_readable)
        self._wake()

    def watch_writable(self, sock: socket.socket, *, wanted: bool) -> None:
        """Also call the callback of a registered socket whenever it can be written, or no more."""
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if wanted else 0)
        with self._state:
            if not self._closed:
                key = self._selector.get_key(sock)
                self._selector.modify(sock, events, key.data)
        self._wake()

    def unregister(self, sock: socket.socket) -> None:
        """Stop watching a socket; to be called before it is closed, without effect if unknown."""
        with self._state:
            if not self._closed:
                with contextlib.suppress(KeyError, ValueError):
                    self._selector.unregister(sock)

    def start(self) -> None:
        """Run the loop on a thread of its own.

        Raises:
            RuntimeError: The loop runs already or was stopped.
        """
        if self._thread is not None or self._closed:
            raise RuntimeError("a loop starts once")
        self._thread = threading.Thread(target=self._run, name="jausml-loop", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread, wait for it (unless called on it) and release the descriptors.

        Another thread must not hold ``lock`` meanwhile: the loop may need it to finish.
        """
        self._stopping = True
        self._wake()
        thread = self._thread
        if thread is None:
            self._close()
        elif thread is not threading.current_thread():
            thread.join()

    def run_once(self, timeout: float | None = None) -> int:
        """Wait for sockets or the next deadline and run what is due.

        Args:
            timeout: Longest wait in seconds; without it as long as nothing happens.

        Returns:
            How many callbacks ran.
        """
        self._runner = threading.get_ident()
        self._woken = False
        events = self._selector.select(self._wait_time(timeout))
        self._woken = True
        ran = self._run_due_timers()
        for key, _ in events:
            ran += self._run_readable(key)
        for _ in range(len(self._soon)):
            ran += self._run_callback(self._soon.popleft())
        return ran

    def _run(self) -> None:
        while not self._stopping:
            self.run_once()
        self._close()

    def _close(self) -> None:
        with self._state:
            if self._closed:
                return
            self._closed = True
            self._timers.clear()
            self._soon.clear()
            self._selector.close()
            self._wake_receiver.close()
            self._wake_sender.close()

    def _wait_time(self, timeout: float | None) -> float | None:
        if self._soon or self._stopping:
            return 0
        with self._state:
            while self._timers and self._timers[0].callback is None:
                heapq.heappop(self._timers)
                self._cancelled -= 1
            if self._timers:
                due = max(0.0, self._timers[0].when - self._clock())
                return due if timeout is None else min(due, timeout)
        return timeout

    def _run_due_timers(self) -> int:
        now = self._clock()
        due: list[Timer] = []
        with self._state:
            while self._timers and self._timers[0].when <= now:
                timer = heapq.heappop(self._timers)
                if timer.callback is None:
                    self._cancelled -= 1
                else:
                    timer.on_cancel = None
                    due.append(timer)
        return sum(self._run_timer(timer) for timer in due)

    def _run_timer(self, timer: Timer) -> int:
        with self.lock:
            callback = timer.callback
            timer.callback = None
            return 0 if callback is None else self._run_callback(callback)

    def _run_readable(self, key: selectors.SelectorKey) -> int:
        if key.fileobj is self._wake_receiver:
            self._drain_wake_ups()
            return 0
        with self.lock:
            with self._state:
                known = None if self._closed else self._selector.get_map().get(key.fd)
            if known is None or known.data is not key.data:
                return 0
            return self._run_callback(key.data)

    def _run_callback(self, callback: Callable[[], None]) -> int:
        with self.lock:
            try:
                callback()
            except Exception as error:
                self.counters.count("loop.callback_failed", repr(error), error=error)
        return 1

    def _timer_cancelled(self) -> None:
        with self._state:
            self._cancelled += 1
            if self._cancelled > _COMPACT_FROM and self._cancelled * 2 > len(self._timers):
                self._timers = [timer for timer in self._timers if timer.callback is not None]
                heapq.heapify(self._timers)
                self._cancelled = 0

    def _wake(self) -> None:
        if self._woken or threading.get_ident() == self._runner:
            return
        self._woken = True
        try:
            self._wake_sender.send(b"\0")
        except OSError:
            return  # full: the loop is awake anyway; closed: nobody waits

    def _drain_wake_ups(self) -> None:
        try:
            self._wake_receiver.recv(4096)
        except OSError:
            return
