"""Runs `jausml operate` as `studio_process.py` does, and tells how long its loops had no turn.

A gap counts as far as this process worked through it: one in which others had the processors is no
matter of what this process does. Usage: gap_process.py PAGE VERB ARGUMENT...; the longest gap of
each loop, in seconds, stands behind `gaps` on its standard error.
"""

from __future__ import annotations

import asyncio
import sys
import threading
import time
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.cli import main
from jausml.live.operating import serving

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

PERIOD = 0.005


class Meter:
    """The longest time for which a loop had no turn, in processor seconds of this process."""

    def __init__(self) -> None:
        self.longest = 0.0
        self._due, self._spent = time.monotonic() + PERIOD, time.process_time()

    def turn(self) -> None:
        """Takes that the loop has a turn."""
        now, spent = time.monotonic(), time.process_time()
        self.longest = max(self.longest, min(now - self._due, spent - self._spent))
        self._due, self._spent = now + PERIOD, spent


METERS = {"pages": Meter(), "JAUS": Meter(), "a thread": Meter()}


def sleep_and_measure() -> None:
    """Measures a thread that does nothing: whoever holds the interpreter holds it up too."""
    while True:
        time.sleep(PERIOD)
        METERS["a thread"].turn()


async def measure_pages() -> None:
    """Measures the loop of the pages."""
    while True:
        await asyncio.sleep(PERIOD)
        METERS["pages"].turn()


class Measured(serving.Unit):
    """A unit whose loops are measured from when it has begun."""

    @asynccontextmanager
    async def _lifespan(self, app: object) -> AsyncIterator[None]:
        async with super()._lifespan(app):  # type: ignore[arg-type]
            system = self.operating.unit._system
            while system.running is None:
                await asyncio.sleep(0.1)
            loop = system.running.transport.loop

            def turn() -> None:
                METERS["JAUS"].turn()
                loop.call_later(PERIOD, turn)

            METERS.update({name: Meter() for name in METERS})
            loop.call_later(PERIOD, turn)
            threading.Thread(target=sleep_and_measure, daemon=True).start()
            measuring = asyncio.create_task(measure_pages())
            yield
            measuring.cancel()
            found = " ".join(f"{meter.longest:.4f}" for meter in METERS.values())
            sys.stderr.write(f"gaps {found}\n")


if __name__ == "__main__":
    serving.PAGE = Path(sys.argv[1])
    serving.Unit = Measured  # type: ignore[misc]
    main(sys.argv[2:])
