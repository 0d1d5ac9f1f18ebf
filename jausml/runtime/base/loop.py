"""The event loop: one thread that waits for descriptors and timers."""

from __future__ import annotations

import heapq
import math
import os
import select
import socket
import threading
import time
from collections import deque
from collections.abc import Callable

from .counters import Clock, Counters
from .fast_path import Revision
from .standstill import Standstill, steady

Poll = Callable[[float | None, int], list[tuple[int, int]]]

# Cancelled timers stay in the heap up to this number: to take out each costs more.
_COMPACT_FROM = 64
_MAX_READY = 64  # descriptors served in one turn; timers run between turns


def due_after(now: float, delay_s: float) -> float:
    """Returns the time after a delay: later than now, unless the delay is 0.

    The delay may be less than the resolution of a large time. A timer that sets itself again must
    be due later all the same, also by a clock that stands still between two turns.
    """
    when = now + delay_s
    return math.nextafter(now, math.inf) if when == now and delay_s > 0.0 else when


class Timer:
    """A callback that a loop runs at a time of its clock."""

    __slots__ = ("callback", "on_cancel")

    def __init__(self, callback: Callable[[], None], on_cancel: Callable[[], None]) -> None:
        """Made by ``Loop.call_at`` and ``Loop.call_later``; `on_cancel` is called once at most."""
        self.callback: Callable[[], None] | None = callback
        self.on_cancel: Callable[[], None] | None = on_cancel

    def cancel(self) -> None:
        """Keeps the callback from running; no effect when it ran or was cancelled."""
        self.callback = None
        on_cancel, self.on_cancel = self.on_cancel, None
        # Removed first, so that a second call has no effect.
        if on_cancel is not None:
            on_cancel()


class Loop:
    """Runs callbacks of descriptors and timers on one thread, each while holding ``lock``.

    ``start`` gives the loop a thread of its own. Without it, ``run_once`` drives the loop from
    the caller's thread, with a clock of the caller's choice. All methods but ``run_once`` may be
    called from any thread. ``stop`` releases the descriptors of the loop and is final.

    A turn does little between its wait and a callback: that adds to the latency of each message.

    Attributes:
        lock: Held while callbacks run; taken once for all callbacks of a turn.
        now: Returns the steady time of the loop in seconds.
        wall: Returns the time of day in nanoseconds since 1970 (UTC).
        stopwatch: Returns a time in seconds that measures how long callbacks take.
        standstill: Notices when the loop did not turn for long.
        revision: The revision of all fast paths.
        on_failure: Called on the thread of the loop with an exception that would end the thread,
            such as SystemExit of user code; the loop goes on. By default it is only counted.
    """

    def __init__(
        self,
        clock: Clock = steady,
        counters: Counters | None = None,
        wall: Callable[[], int] = time.time_ns,
        stopwatch: Clock = time.perf_counter,
    ) -> None:
        # Reentrant, as callbacks call what other threads call too.
        self.lock = threading.RLock()
        self.counters = Counters(clock) if counters is None else counters
        self.now = clock
        self.wall = wall
        self.stopwatch = stopwatch
        self.on_failure: Callable[[BaseException], object] = self._failed
        self._epoll = select.epoll()
        self._poll: Poll = self._epoll.poll
        self._settle: Callable[[], None] | None = None
        self._wake_up = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._epoll.register(self._wake_up, select.EPOLLIN)
        self._callbacks: dict[int, Callable[[], object]] = {}
        # A turn may have found a former descriptor of the same number ready.
        self._renewed: set[int] = set()
        self._state = threading.Lock()
        self._timers: list[tuple[float, int, Timer]] = []
        self._created = 0
        self._cancelled = 0
        self._soon: deque[Callable[[], object]] = deque()
        # True when the loop needs no waking: it is busy, or was woken already.
        self._woken = False
        self.standstill = Standstill(self)
        self.revision = Revision()
        self._thread: threading.Thread | None = None
        self._runner = 0
        self._stopping = False
        self._closed = False

    def __enter__(self) -> Loop:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def call_soon(self, callback: Callable[[], object]) -> None:
        """Runs a callback in the next turn of the loop, in the order of the calls."""
        # Appending to a deque is atomic: no lock is needed.
        self._soon.append(callback)
        self._wake()

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback after a delay in seconds."""
        return self.call_at(due_after(self.now(), delay_s), callback)

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback at a time of the loop's clock."""
        timer = Timer(callback, self._timer_cancelled)
        with self._state:
            self._created += 1
            # The number orders timers of equal times by their creation.
            heapq.heappush(self._timers, (when, self._created, timer))
            is_earliest = self._timers[0][2] is timer
        if is_earliest:
            self._wake()
        return timer

    def register(self, source: socket.socket | int, on_readable: Callable[[], object]) -> None:
        """Calls ``on_readable`` whenever a socket or descriptor is readable."""
        number = _number(source)
        with self._state:
            self._renewed.add(number)
            self._epoll.register(number, select.EPOLLIN)
            self._callbacks[number] = on_readable

    def watch_writable(self, source: socket.socket | int, *, wanted: bool) -> None:
        """Has the callback of a registered socket called when writable, too, or no more."""
        events = select.EPOLLIN | (select.EPOLLOUT if wanted else 0)
        with self._state:
            if not self._closed:
                self._epoll.modify(_number(source), events)

    @property
    def descriptor(self) -> int:
        """A descriptor that is readable when one of the registered descriptors is ready."""
        return self._epoll.fileno()

    def wait_by(self, poll: Poll | None, settle: Callable[[], None] | None) -> None:
        """Sets how the loop waits from the next turn on; None stands for epoll.

        Args:
            poll: Waits as `select.epoll.poll` does.
            settle: Called with the lock after each wait, before the callbacks.
        """
        self._poll, self._settle = poll or self._epoll.poll, settle
        # To end the wait under way.
        self._wake()

    def unregister(self, source: socket.socket | int) -> None:
        """Stops watching a descriptor; to be called before it is closed, no effect if unknown."""
        number = _number(source)
        with self._state:
            if not self._closed and self._callbacks.pop(number, None) is not None:
                self._epoll.unregister(number)

    def is_idle(self) -> bool:
        """Returns whether no descriptor is ready; to be called by a callback."""
        return not self._epoll.poll(0, 1)

    def start(self) -> None:
        """Runs the loop on a thread of its own; raises RuntimeError if it runs or was stopped."""
        if self._thread is not None or self._closed:
            raise RuntimeError("a loop starts once")
        self._thread = threading.Thread(target=self._run, name="jausml-loop", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread, waits for it (unless called on it) and releases the descriptors.

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
        """Waits at most `timeout` seconds, and runs due callbacks; returns their number."""
        return self._turn(timeout, is_only=True)

    def runs_here(self) -> bool:
        """Returns whether the caller is on the thread of the loop, and so must not wait for it."""
        return threading.get_ident() == self._runner

    def next_due(self) -> float | None:
        """Returns the loop time of the next callback; None without one.

        The driver of a simulated clock advances it to this time. Descriptors are not considered.
        """
        if self._soon:
            return self.now()
        with self._state:
            while self._timers and self._timers[0][2].callback is None:
                heapq.heappop(self._timers)
                self._cancelled -= 1
            return self._timers[0][0] if self._timers else None

    def _turn(  # noqa: C901 - each call would delay messages
        self, timeout: float | None, *, is_only: bool
    ) -> int:
        """Takes one turn, or turns until the loop stops; returns the callbacks of the last turn.

        Ready descriptors are served first, before a look at the clock.
        """
        self._runner = threading.get_ident()
        # Local names, as each look-up of an attribute would delay messages.
        lock, now = self.lock, self.now
        callbacks, renewed, timers, soon = (
            self._callbacks,
            self._renewed,
            self._timers,
            self._soon,
        )
        while True:
            if renewed:
                renewed.clear()
            # Before the timers are read: one that is added later wakes the loop.
            self._woken = False
            with self._state:
                first = timers[0] if timers else None
            # The usual case is a pending timer and nothing else; other cases take one more call.
            if first is None or first[2].callback is None or soon or timeout is not None:
                wait = self._wait_time(timeout)
            elif self._stopping or (wait := first[0] - now()) < 0.0:
                wait = 0.0
            ready = self._poll(wait, _MAX_READY)
            # The loop needs no waking until it waits again.
            self._woken = True
            ran = 0
            with lock:
                # The core passed its messages before those that are ready now.
                if self._settle is not None:
                    self._settle()
                for number, _ in ready:
                    callback = callbacks.get(number)
                    if callback is None or (renewed and number in renewed):
                        if number == self._wake_up:
                            os.eventfd_read(number)
                        continue
                    try:
                        callback()
                    except Exception as error:
                        self._failed(error)
                    ran += 1
                # Without `_state`: the read is atomic, and an earlier timer wakes the loop.
                if timers and timers[0][0] <= now():
                    ran += self._run_due_timers()
                # Only those of now: a callback that calls itself again must not hold up others.
                for _ in range(len(soon)):
                    ran += self._run_callback(soon.popleft())
            if is_only or self._stopping:
                return ran

    def _run(self) -> None:
        while not self._stopping:
            try:
                self._turn(None, is_only=False)
            except BaseException as error:  # SystemExit of overridden methods too
                self.on_failure(error)
        self._close()

    def _close(self) -> None:
        with self._state:
            if self._closed:
                return
            self._closed = True
            self._timers.clear()
            self._soon.clear()
            self._callbacks.clear()
            self._epoll.close()
            os.close(self._wake_up)

    def _wait_time(self, timeout: float | None) -> float | None:
        if self._soon or self._stopping:
            return 0
        due = self.next_due()
        if due is None:
            return timeout
        wait = max(0.0, due - self.now())
        return wait if timeout is None else min(wait, timeout)

    def _run_due_timers(self) -> int:
        """Runs due timers, except those that are created meanwhile; returns their number."""
        now, newest = self.now(), self._created
        ran = 0
        while True:
            with self._state:
                if not self._timers or self._timers[0][0] > now or self._timers[0][1] > newest:
                    return ran
                _, _, timer = heapq.heappop(self._timers)
                callback = timer.callback
                if callback is None:
                    self._cancelled -= 1
                    continue
                # It runs: cancelling has no effect from here on.
                timer.callback = timer.on_cancel = None
            ran += self._run_callback(callback)

    def _run_callback(self, callback: Callable[[], object]) -> int:
        try:
            callback()
        except Exception as error:
            self._failed(error)
        return 1

    def _failed(self, error: BaseException) -> None:
        self.counters.count("loop.callback_failed", repr(error), error=error)

    def _timer_cancelled(self) -> None:
        with self._state:
            self._cancelled += 1
            if self._cancelled > _COMPACT_FROM and self._cancelled * 2 > len(self._timers):
                # In place: a turn may be reading the list.
                self._timers[:] = [timer for timer in self._timers if timer[2].callback is not None]
                heapq.heapify(self._timers)
                self._cancelled = 0

    def _wake(self) -> None:
        # On its own thread the loop is awake.
        if self._woken or self.runs_here():
            return
        with self._state:
            if not self._closed:
                self._woken = True
                os.eventfd_write(self._wake_up, 1)


def _number(source: socket.socket | int) -> int:
    return source if isinstance(source, int) else source.fileno()
