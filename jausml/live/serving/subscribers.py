"""Subscribers to events."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from jausml.live.serving import rpc


class Subscribers:
    """The listeners to events; any thread may tell."""

    def __init__(self) -> None:
        self._listeners: list[Callable[[str], None]] = []
        self._lock = threading.Lock()
        self.left: Callable[[], None] = lambda: None
        """Is called when the last listener goes."""

    @contextmanager
    def subscribed(self, listener: Callable[[str], None]) -> Iterator[None]:
        """Reports events to a listener as long as the context lasts.

        `listener`: takes messages, from any thread.
        """
        with self._lock:
            self._listeners.append(listener)
        try:
            yield
        finally:
            with self._lock:
                self._listeners.remove(listener)
                is_last = not self._listeners
            if is_last:
                self.left()

    def notify(self, method: str, params: object) -> None:
        """Sends a notification to all listeners."""
        message = rpc.notification(method, params)
        with self._lock:
            listeners = list(self._listeners)
        for listener in listeners:
            listener(message)
