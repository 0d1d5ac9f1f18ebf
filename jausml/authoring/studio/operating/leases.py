"""Leases: what lasts only while a page says so again and again, and a stick that ends in a stop."""

from __future__ import annotations

import time
from threading import Condition, RLock, Thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.runtime.wire.message import Message


class Lease:
    """Lasts for some seconds from each renewal; a thread of its own ends it, nobody else has to."""

    def __init__(self, seconds: float, expired: Callable[[], None]) -> None:
        """Begins it (`expired`: is called once, on that thread, when nobody renews it)."""
        self.seconds = seconds
        self._expired = expired
        self._due = time.monotonic() + seconds
        self._is_over = False
        self._news = Condition()
        Thread(target=self._run, name="lease", daemon=True).start()

    def renew(self) -> bool:
        """Renews it; False when it is over, or the time is up and its thread has yet to see it."""
        with self._news:
            now = time.monotonic()
            if self._is_over or now >= self._due:
                return False
            self._due = now + self.seconds
            return True

    def end(self) -> None:
        """Ends it, without `expired`."""
        with self._news:
            self._is_over = True
            self._news.notify()

    def _run(self) -> None:
        with self._news:
            while not self._is_over and (left := self._due - time.monotonic()) > 0:
                self._news.wait(left)
            if self._is_over:
                return
            self._is_over = True
        self._expired()


class StickOverError(Exception):
    """The stick is released, or its lease has ended: nothing is sent by it any more."""


class Stick:
    """A command sent again and again by a hand; whatever ends it sends the stop.

    Nothing of the stick follows its stop: what comes later is refused.
    """

    def __init__(
        self,
        seconds: float,
        send: Callable[[Message], None],
        stop: Callable[[], None],
        ended: Callable[[str], None],
    ) -> None:
        """Begins with nothing sent.

        Args:
            seconds: How long one word of the page holds.
            stop: Sends the stop.
            ended: Is told why it ended, on any thread.
        """
        self._send, self._stop, self._ended = send, stop, ended
        self._lock = RLock()
        self._is_over = False
        self._lease = Lease(seconds, self._expired)

    def move(self, message: Message) -> None:
        """Sends a message, and holds the stick for another while."""
        with self._lock:
            if not self._lease.renew():
                raise StickOverError("the stick was released, or its page was silent too long")
            self._send(message)

    def end(self, why: str) -> None:
        """Sends the stop, unless it was sent."""
        with self._lock:
            if self._is_over:
                return
            self._is_over = True
            self._lease.end()
            self._stop()
        self._ended(why)

    def _expired(self) -> None:
        self.end(f"the page said nothing for {self._lease.seconds:g} s")
