"""Runs `jausml operate` as `studio_process.py` does, and tells what kept its loops from a turn.

Only time counts in which a thread of this process worked: how long others had the processors is no
matter of what this process does. Usage: gap_process.py PAGE VERB ARGUMENT...; at its end it writes
JSON to its standard error, behind `worked`: the longest work of each thread without a turn, in
processor seconds, and which modules are loaded that read models.
"""

from __future__ import annotations

import asyncio
import gc
import json
import sys
import time
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.cli import main
from jausml.live.operating import serving

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from jausml.live.operating.knowledge import Knowledge

PERIOD = 0.005
READERS = ("jausml.language.metamodel", "jausml.language.model", "pyecore")


class Meter:
    """The longest work of one thread between two turns, in its own processor seconds."""

    def __init__(self) -> None:
        self.turns = 0
        self.longest = 0.0
        self._spent = 0.0

    def begin(self) -> None:
        """Takes that the thread begins to work."""
        self._spent = time.thread_time()

    def turn(self) -> None:
        """Takes that it has a turn."""
        spent = time.thread_time()
        self.longest = max(self.longest, spent - self._spent)
        self._spent = spent
        self.turns += 1


class Measured(serving.Unit):
    """A unit that is measured from when it has begun."""

    @asynccontextmanager
    async def _lifespan(self, app: object) -> AsyncIterator[None]:
        names = "pages", "JAUS", "learning", "collector"
        meters = pages, jaus, learning, collector = [Meter() for _ in names]
        following = self.learning._next

        def unpickled() -> Knowledge | None:
            learning.begin()
            knowledge = following()
            learning.turn()
            return knowledge

        # Unpickling is one call, for as long as which that thread has the interpreter.
        self.learning._next = unpickled  # type: ignore[method-assign]
        async with super()._lifespan(app):  # type: ignore[arg-type]
            system = self.operating.unit._system
            while system.running is None:
                await asyncio.sleep(0.1)
            loop = system.running.transport.loop

            def turn() -> None:
                jaus.turn()
                loop.call_later(PERIOD, turn)

            def begin() -> None:
                jaus.begin()
                turn()

            async def measure_pages() -> None:
                pages.begin()
                while True:
                    await asyncio.sleep(PERIOD)
                    pages.turn()

            gc.callbacks.append(
                lambda phase, _: collector.begin() if phase == "start" else collector.turn()
            )
            loop.call_later(PERIOD, begin)
            measuring = asyncio.create_task(measure_pages())
            yield
            measuring.cancel()
            gc.callbacks.pop()
            found = {name: meter.longest for name, meter in zip(names, meters, strict=True)}
            loaded = [name for name in sys.modules if name.startswith(READERS)]
            turns = min(meter.turns for meter in (pages, jaus, learning))
            told = {"longest": found, "turns": turns, "readers": loaded}
            sys.stderr.write(f"worked {json.dumps(told)}\n")


if __name__ == "__main__":
    serving.PAGE = Path(sys.argv[1])
    serving.Unit = Measured  # type: ignore[misc]
    main(sys.argv[2:])
