"""How far a long run is: one line that changes on a terminal, plain lines in a log."""

from __future__ import annotations

import time
from threading import Lock
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TextIO

_BETWEEN_LINES = 5.0
"""Least seconds between two lines of a log that tell of the same stage."""


def clock(seconds: float) -> str:
    """Returns minutes and seconds, such as 3:07."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


class Progress:
    """Tells what is done now; may be called from several threads.

    Args:
        stream: Where to.
        width: Columns of the terminal; None where there is no terminal, so that lines are added.
        now: Seconds, monotonic.
    """

    def __init__(
        self, stream: TextIO, width: int | None, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._stream = stream
        self._width = width
        self._now = now
        self._begun = now()
        self._lock = Lock()
        self._heading = ""
        self._detail = ""
        self._since = self._begun
        self._limit = 0.0
        self._last_line = -_BETWEEN_LINES

    @property
    def elapsed(self) -> float:
        """Seconds since the beginning of all."""
        return self._now() - self._begun

    def begin(self, heading: str, limit: float) -> None:
        """Begins a stage.

        Args:
            heading: What is done.
            limit: Seconds that it may take at most.
        """
        with self._lock:
            self._heading, self._detail = heading, ""
            self._since, self._limit = self._now(), limit
            self._last_line = -_BETWEEN_LINES
        self.refresh()

    def tell(self, detail: str) -> None:
        """Says how far the stage is."""
        with self._lock:
            self._detail = detail
        self.refresh()

    def refresh(self) -> None:
        """Shows the stage again, with the time it has taken; a log gets a line now and then."""
        with self._lock:
            now = self._now()
            if self._width is not None:
                text = self._line(now)[: self._width - 1]
                self._stream.write(f"\r\x1b[K{text}")
            elif now - self._last_line >= _BETWEEN_LINES:
                self._last_line = now
                self._stream.write(f"{self._line(now)}\n")
            else:
                return
            self._stream.flush()

    def end(self, outcome: str) -> None:
        """Ends the stage with a line that stays."""
        with self._lock:
            took = clock(self._now() - self._since)
            begin = "\r\x1b[K" if self._width is not None else ""
            self._stream.write(f"{begin}{self._heading}: {outcome} ({took})\n")
            self._stream.flush()

    def _line(self, now: float) -> str:
        times = f"{clock(now - self._since)} of at most {clock(self._limit)}"
        detail = f": {self._detail}" if self._detail else ""
        return f"{self._heading} ({times}){detail}"
