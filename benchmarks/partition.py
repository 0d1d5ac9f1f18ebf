"""What becomes of commands beside a heavy topic: in one bridge, and parted in two."""

from __future__ import annotations

import gc
import random
import time
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING, Any

from counterpart import Counterpart
from ends import RosEnd
from figures import Blocks
from names import WAYS
from processes import Children
from samples import sample
from systems import Measured, generate
from variants import Loop, Route, settle

if TYPE_CHECKING:
    from pathlib import Path

    from scale import Scale

ALONE, JOINED, PARTED = "without grids", "one bridge", "two bridges"
CASES = (ALONE, JOINED, PARTED)

GRID_RATE = 125
"""Grids of 40 kB a second: 5 MB."""

_PACE = 0.004
_BLOCKS = 5
_SECONDS = 1.2
_SETTLE = 0.05


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures twists both ways while grids of 5 MB a second pass down.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by way and case in microseconds; ratios are to the bridge that has both.
    """
    system = generate(
        folder,
        {
            "joined": Measured(("twist",), load=True),
            "command": Measured(("twist",)),
            "heavy": Measured((), load=True),
        },
    )
    message, grid = sample(system.model, "twist"), sample(system.model, "grid")
    blocks = {way: Blocks() for way in WAYS}
    seconds = max(_SECONDS * scale.factor, 0.2)
    with (
        Children(system.environment(), folder / "processes.log") as children,
        closing(RosEnd("meter")) as ros,
    ):
        joined = Loop("joined", ros, system, "joined", message)
        parted = Loop("parted", ros, system, "command", message)
        heavy = Route("heavy", system, "heavy", grid)
        topics = {joined: "/joined/load_down", parted: "/heavy/load_down"}
        sinks = [str(each.port) for each in (joined, heavy)]
        other = Counterpart(children, folder, grid, "--publish", *topics.values(), "--sink", *sinks)
        for each in (joined, parted, heavy):
            each.start(children, folder)
        for loop in topics:
            loop.reach()
        for carrier, bridge in ((joined, "joined"), (heavy, "heavy")):
            carrier.until(partial(_carries, other, system.address(bridge), f"/{carrier.variant}"))
        settle(list(topics))
        cases = [(ALONE, joined, ""), (JOINED, joined, topics[joined])]
        cases.append((PARTED, parted, topics[parted]))
        order = [(*case, way) for case in cases for way in WAYS]
        gc.disable()
        for _ in range(scale.count(_BLOCKS, 2)):
            for block in blocks.values():
                block.begin()
            random.shuffle(order)
            for name, loop, topic, way in order:
                if topic:
                    other.begin("publish", topic=topic, rate=GRID_RATE, seconds=seconds + _SETTLE)
                _exchange(loop, way, seconds, partial(blocks[way].add, name))
                if topic:
                    other.answer()
                    other.ask("take", seconds=0)
        gc.enable()
        other.begin("end")
        for each in (joined, parted, heavy):
            each.close()
    found = {way: each.summary(against=JOINED) for way, each in blocks.items()}
    return {
        way: {case: figures[case] for case in CASES if case in figures}
        for way, figures in found.items()
    }


def _carries(other: Counterpart, address: tuple[int, int, int], prefix: str) -> bool:
    """Whether grids come through a bridge, which is told where the sink is."""
    other.ask("greet", address=address)
    published = other.ask("publish", topic=f"{prefix}/load_down", rate=1, seconds=0.1)
    # One datagram is the answer to the greeting.
    return published["sunk"] + other.ask("take", seconds=0.2)["sunk"] > 1


def _exchange(loop: Loop, way: str, seconds: float, into: Any) -> None:
    """Exchanges messages for some time, one after the other."""
    time.sleep(_SETTLE)
    loop.discard()
    end = time.perf_counter() + seconds - _SETTLE
    while time.perf_counter() < end:
        into(loop.exchange(way))
        time.sleep(_PACE)
