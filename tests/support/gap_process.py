"""Runs `jausml operate` as `studio_process.py` does, and tells what kept its loops from a turn.

Only what this process did counts: how long others had the processors is no matter of it. Usage:
gap_process.py PAGE VERB ARGUMENT...; at its end it writes JSON to its standard error, behind
`worked`: the longest work of its loops, and of who unpickles what was read, without a turn, in
processor seconds of that thread; the collections while somebody commanded; and the modules that
read models.
"""

from __future__ import annotations

import asyncio
import gc
import json
import sys
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from jausml.cli import main
from jausml.live.operating import serving
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


class Measured(serving.OperatorSite):
    """A unit that is measured from when it has begun."""

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        meters = pages, jaus, learning = Meter(), Meter(), Meter()
        unit, collections = self.unit, list[object]()
        following = self.learning._next

        def unpickled() -> Knowledge | None:
            learning.begin()
            knowledge = following()
            learning.turn()
            return knowledge

        # Unpickling is one call, for as long as which that thread has the interpreter.
        self.learning._next = unpickled  # type: ignore[method-assign]
        async with super().running():
            system = unit.system
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

            def collected(_: object, generation: object) -> None:
                if unit._commander is not None:
                    collections.append(generation)

            gc.callbacks.append(collected)
            loop.call_later(PERIOD, begin)
            measuring = asyncio.create_task(measure_pages())
            yield
            measuring.cancel()
            gc.callbacks.pop()
            told = {
                "longest": [meter.longest for meter in meters],
                "turns": [meter.turns for meter in meters],
                "collections": collections,
                "readers": [name for name in sys.modules if name.startswith(READERS)],
            }
            sys.stderr.write(f"worked {json.dumps(told)}\n")


if __name__ == "__main__":
    serving.PAGE = Path(sys.argv[1])
    serving.OperatorSite = Measured  # type: ignore[misc]
    main(sys.argv[2:])
