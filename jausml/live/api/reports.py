"""What comes to a component: messages, and the reports of an event one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from queue import Empty, Full, Queue
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

Fields = dict[str, Any]
"""Fields of a message by their names, without the one record of a body."""

MOST_WAITING = 1000
"""Reports that wait to be taken; then the oldest is thrown away."""


@dataclass(frozen=True)
class Received:
    """A message that came.

    Attributes:
        fields: Its fields, in units of the standard.
    """

    name: str
    fields: Fields
    sender: str


class Subscription:
    """Reports of an event, to be iterated over; ends with `close`.

    Attributes:
        missed: Reports that were thrown away because nobody took them in time, the oldest first.
    """

    def __init__(self) -> None:
        self.missed = 0
        self._reports: Queue[Received | None] = Queue(MOST_WAITING)
        self._cancel: Callable[[], None] | None = None

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Received]:
        """Yields reports as they come, until the subscription is closed."""
        while (report := self._reports.get()) is not None:
            yield report

    def next(self, timeout: float | None = None) -> Received:
        """Returns the next report.

        Args:
            timeout: Seconds to wait; None waits forever.

        Raises:
            TimeoutError: None came in time, or the subscription is closed.
        """
        try:
            report = self._reports.get(timeout=timeout)
        except Empty:
            raise TimeoutError(f"no report within {timeout:g} s") from None
        if report is None:
            raise TimeoutError("the subscription is closed")
        return report

    def close(self) -> None:
        """Cancels the event."""
        if self._cancel is not None:
            self._cancel()
            self._cancel = None
        self.take(None)

    def take(self, report: Received | None) -> None:
        """Takes a report, on another thread; None ends the iteration."""
        while True:
            try:
                self._reports.put_nowait(report)
            except Full:
                self._drop()
            else:
                return

    def begin(self, cancel: Callable[[], None]) -> None:
        """Takes what cancels the event at the end."""
        self._cancel = cancel

    def _drop(self) -> None:
        try:
            self._reports.get_nowait()
        except Empty:
            return
        self.missed += 1
