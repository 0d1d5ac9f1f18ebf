"""What becomes of single messages while others pass through the same bridge."""

from __future__ import annotations

import gc
import random
import statistics
import time
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING, Any

from counterpart import Counterpart
from ends import PEER, RosEnd, datagrams
from figures import Blocks
from names import COMPILED, FLOOR, GENERATED, GENERIC, TYPED, WAYS
from processes import Children
from samples import sample
from systems import Measured, generate
from variants import Loop, reached, settle

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from scale import Scale

OTHER_WAY_RATE = 2000
"""Messages a second in the other direction."""

GRID_RATE = 25
"""Grids of 40 kB a second: 1 MB."""

_PACE = 0.004
_BLOCKS = 5
_SECONDS = 1.2
"""Time of a variant and way in each block."""

_TAIL = 0.999
_SETTLE = 0.05


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures each way of stamped points while the other way is loaded.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by way and variant in microseconds; the tail is the 99.9th percentile.
    """
    system = generate(folder, {"one_point": Measured(("point",))})
    system.compile()
    message = sample(system.model, "point")
    blocks = {way: Blocks() for way in WAYS}
    seconds = max(_SECONDS * scale.factor, 0.2)
    with (
        Children(system.environment(), folder / "processes.log") as children,
        closing(RosEnd("meter")) as ros,
    ):
        variants = scale.cases((FLOOR, COMPILED, GENERATED, TYPED, GENERIC), 3)
        loops = [Loop(each, ros, system, "one_point", message) for each in variants]
        to = ":".join(map(str, system.address("one_point")))
        shared = [f"{loop.end.sock.fileno()}:{loop.port}:{to}" for loop in loops]
        options = ["--publish", *[each.topic("down") for each in loops], "--shared", *shared]
        sockets = [loop.end.sock for loop in loops]
        other = Counterpart(children, folder, message, *options, shared=sockets)
        for loop in loops:
            loop.start(children, folder)
        numbers = {loop: number for number, loop in enumerate(loops)}
        loops = reached(loops, Loop.reach)
        settle(loops)
        order = [(loop, numbers[loop], way) for loop in loops for way in WAYS]
        gc.disable()
        for _ in range(scale.count(_BLOCKS, 2)):
            for each in blocks.values():
                each.begin()
            random.shuffle(order)
            for loop, number, way in order:
                pace = {"rate": OTHER_WAY_RATE, "seconds": seconds + 2 * _SETTLE}
                if way == "up":
                    other.begin("publish", topic=loop.topic("down"), **pace)
                else:
                    other.begin("send", which=number, **pace)
                _exchanges(loop, way, partial(blocks[way].add, loop.variant), seconds)
                other.answer()
        gc.enable()
        other.begin("end")
        for loop in loops:
            loop.close()
    return {way: each.summary(tail=_TAIL) for way, each in blocks.items()}


def measure_beside_grids(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures twists while grids of 1 MB a second pass through the same bridge, and without them.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by way and variant; `VARIANT alone` is the same bridge without grids, to which the
        ratios are; `carried` has the share of the grids that came through, by variant.
    """
    system = generate(folder, {"loaded": Measured(("twist",), load=True)})
    system.compile()
    message, grid = sample(system.model, "twist"), sample(system.model, "grid")
    variants = scale.cases((COMPILED, GENERATED, TYPED), 2)
    blocks = {(way, variant): Blocks() for way in WAYS for variant in variants}
    carried: dict[str, list[float]] = {each: [] for each in variants}
    datagrams_each = len(datagrams(grid.jaus, PEER, PEER))
    seconds = max(_SECONDS * scale.factor, 0.2)
    with (
        Children(system.environment(), folder / "processes.log") as children,
        closing(RosEnd("meter")) as ros,
    ):
        loops = [Loop(each, ros, system, "loaded", message) for each in variants]
        topics = [f"/{each}/load_down" for each in variants]
        ports = [str(each.port) for each in loops]
        options = ["--publish", *topics, "--sink", *ports]
        other = Counterpart(children, folder, grid, *options)
        for loop in loops:
            loop.start(children, folder)
        loops = reached(loops, Loop.reach)
        other.ask("greet", address=system.address("loaded"))
        loops = reached(loops, partial(_carries_grids, other))
        settle(loops)
        order = [
            (loop, f"/{loop.variant}/load_down", way, beside)
            for loop in loops
            for way in WAYS
            for beside in (True, False)
        ]
        gc.disable()
        for _ in range(scale.count(_BLOCKS, 2)):
            for each in blocks.values():
                each.begin()
            random.shuffle(order)
            for loop, topic, way, beside in order:
                name = loop.variant if beside else f"{loop.variant} alone"
                into = partial(blocks[way, loop.variant].add, name)
                if beside:
                    sunk = _beside_grids(other, topic, loop, way, into, seconds)
                    carried[loop.variant].append(sunk / datagrams_each)
                else:
                    _exchanges(loop, way, into, seconds)
        gc.enable()
        other.begin("end")
        for loop in loops:
            loop.close()
    found: dict[str, Any] = {way: {} for way in WAYS}
    for (way, variant), each in blocks.items():
        found[way].update(each.summary(against=f"{variant} alone"))
    found["carried"] = {
        each: round(statistics.median(shares), 3) for each, shares in carried.items() if shares
    }
    return found


def _carries_grids(other: Counterpart, loop: Loop) -> None:
    """Waits until grids come through.

    Raises:
        UnreachableError: None did.
    """

    def came() -> bool:
        published = other.ask("publish", topic=f"/{loop.variant}/load_down", rate=1, seconds=0.1)
        # One datagram is the answer to the greeting.
        return published["sunk"] + other.ask("take", seconds=0.2)["sunk"] > 1

    loop.until(came)


def _beside_grids(
    other: Counterpart,
    topic: str,
    loop: Loop,
    way: str,
    into: Callable[[float | None], None],
    seconds: float,
) -> float:
    """Exchanges messages while grids are published; returns how many datagrams each grid gave."""
    other.begin("publish", topic=topic, rate=GRID_RATE, seconds=seconds + 2 * _SETTLE)
    _exchanges(loop, way, into, seconds)
    answer = other.answer()
    # What has not come through yet must not disturb the next turn.
    return (answer["sunk"] + other.ask("take", seconds=0)["sunk"]) / answer["sent"]


def _exchanges(loop: Loop, way: str, into: Callable[[float | None], None], seconds: float) -> None:
    """Exchanges messages for some time, and throws away what the other way brings."""
    time.sleep(_SETTLE)
    loop.discard()
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        into(loop.exchange(way))
        time.sleep(_PACE / 2)
        if way == "up":
            loop.end.discard()
        else:
            loop.subscription.discard()
