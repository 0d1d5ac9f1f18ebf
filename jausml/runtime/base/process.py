"""Log, signals, the wait for the end, and exit codes of all processes."""

from __future__ import annotations

import atexit
import logging
import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from queue import SimpleQueue
from types import FrameType

from .api import JausError
from .counters import LOGGER

LOG_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"

LOG_LEVELS = ("debug", "info", "warn", "warning", "error")

EXIT_OK = 0
EXIT_FAILED = 1
EXIT_USAGE = 2


def failed(name: str, error: Exception) -> int:
    """Logs why a process could not run; returns its exit code."""
    if isinstance(error, OSError):
        LOGGER.error("%s cannot use the network: %s", name, error)
    elif isinstance(error, JausError):
        LOGGER.error("%s cannot run: %s", name, error)
    else:
        LOGGER.error("%s failed", name, exc_info=error)
    return EXIT_FAILED


def configure_log(level: str) -> None:
    """Logs to standard error from a level on, one of `LOG_LEVELS`."""
    logging.basicConfig(format=LOG_FORMAT, level=level.upper())


def log_counts(label: str, counts: Mapping[str, int]) -> None:
    """Logs names and numbers on one line, at the end of a process."""
    pairs = " ".join(f"{name}={number}" for name, number in counts.items())
    LOGGER.info("%s: %s", label, pairs or "none")


class StopRequest:
    """Ends the wait of the main thread; may be requested by signals and by any thread."""

    def __init__(self) -> None:
        # Unlike Event.set, SimpleQueue.put may be called in a signal handler that interrupts
        # the very thread that waits.
        self._requests: SimpleQueue[str | BaseException] = SimpleQueue()

    def request(self, reason: str) -> None:
        """Ends the wait for a reason, which `wait` returns."""
        self._requests.put(reason)

    def fail(self, error: BaseException) -> None:
        """Ends the wait by the error of an indispensable thread, which `wait` raises."""
        self._requests.put(error)

    def wait(self) -> str:
        """Waits for a request and returns its reason; raises the error of a failed thread."""
        request = self._requests.get()
        if isinstance(request, BaseException):
            raise request
        return request

    @contextmanager
    def on_signals(self) -> Iterator[None]:
        """Lets SIGINT, SIGTERM, and SIGHUP of a lost terminal request the stop during a block."""

        def handle(number: int, _frame: FrameType | None) -> None:
            self.request(signal.Signals(number).name)

        atexit.register(ignore_signals)
        former = {number: signal.signal(number, handle) for number in end_signals()}
        try:
            yield
        finally:
            for number, handler in former.items():
                signal.signal(number, handler)


def ignore_signals() -> None:
    """Ignores further signals to end, so that a process at its end is not interrupted."""
    for number in end_signals():
        signal.signal(number, signal.SIG_IGN)


def end_signals() -> Iterator[int]:
    """Yields the signals that ask a process to end: SIGINT, SIGTERM and SIGHUP of a lost terminal.

    The last one is none where it is ignored, as `nohup` has it.
    """
    yield from (signal.SIGINT, signal.SIGTERM)
    hang_up = getattr(signal, "SIGHUP", None)  # Windows has none
    if hang_up is not None and signal.getsignal(hang_up) != signal.SIG_IGN:
        yield hang_up
