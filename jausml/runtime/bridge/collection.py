"""Garbage collection of a bridge: at quiet moments, and not of what lives as long as it does.

After its start a bridge has tens of thousands of objects, of which nothing ever becomes garbage.
Each full collection looks at all of them, for tens of milliseconds in which no message moves. So
they are set aside, and what came later is collected when nothing waits to be served.
"""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..base.loop import Loop

PERIOD = 1.0
"""Seconds between two collections."""

LONGEST_DELAY = 10.0
"""Seconds after which garbage is collected at a moment that is not quiet, too."""


@contextmanager
def without_collection() -> Iterator[None]:
    """Collects nothing by itself within the block; to be entered once in a process."""
    gc.disable()
    try:
        yield
    finally:
        gc.unfreeze()
        gc.enable()


class QuietCollection:
    """Collects garbage when a loop has nothing to do."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._last = loop.now()

    def start(self) -> None:
        """Sets aside what is there, and collects what comes later from now on."""
        gc.freeze()
        self._last = self._loop.now()
        self._loop.call_later(PERIOD, self._run)

    def _run(self) -> None:
        if self._loop.is_idle() or self._loop.now() - self._last >= LONGEST_DELAY:
            gc.collect()
            self._last = self._loop.now()
        self._loop.call_later(PERIOD, self._run)
