"""Latency of each way through a bridge, at several rates and with many connections.

The variants take turns: at 10 and 100 messages a second each period has an exchange of every
variant and way, in an order that is shuffled for each block; at 1000 each has short bursts.
"""

from __future__ import annotations

import gc
import random
import time
from contextlib import closing
from typing import TYPE_CHECKING, Any

from ends import RosEnd
from figures import Blocks
from names import FLOOR, GENERATED, GENERIC, KINDS, VARIANTS, WAYS
from processes import Children
from samples import sample
from systems import MAPS, Measured, generate
from variants import Loop, reached, settle

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from samples import Sample
    from scale import Scale
    from systems import System

IDLE = (1, 150, 300)
"""Connections each way."""

_RATES = {10: 60, 100: 500, 1000: 1000}
"""Messages a second, and how many are measured of each variant and way."""

_BLOCKS = 10
_CAP = 0.4
"""Longest burst in seconds."""

_SHARE = 0.6
"""Part of a period that all exchanges of it may take together."""

_MOST_SLOW = 30
"""Samples of what is too slow for a rate."""

_Path = tuple[Loop, str]


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures each kind of message on a bridge of its own.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by kind, rate, way and variant, in microseconds.
    """
    kinds = scale.cases(tuple(KINDS), 2)
    names = {kind: f"one_{KINDS[kind][0]}" for kind in kinds}
    bridges = {f"one_{each}": Measured((each,)) for each in MAPS if f"one_{each}" in names.values()}
    system = generate(folder, bridges)
    found = {}
    with closing(RosEnd("meter")) as ros:
        for kind in kinds:
            message = sample(system.model, kind)
            found[kind] = side_by_side(scale, folder, system, names[kind], message, ros, VARIANTS)
    return found


def measure_connections(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures stamped points on bridges with many more connections that carry nothing.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by connections each way, way and variant at 100 messages a second.
    """
    variants = (FLOOR, GENERATED, GENERIC)
    found = {}
    with closing(RosEnd("meter")) as ros:
        for count in scale.cases(IDLE, 2):
            # Systems of their own, since bridges of one system share a package of messages.
            own = folder / str(count)
            own.mkdir()
            name = f"with_{count}"
            system = generate(own, {name: Measured(("point",), 2 * (count - 1))})
            message = sample(system.model, "point")
            figures = side_by_side(scale, folder, system, name, message, ros, variants, (100,))
            found[str(count)] = figures["100"]
    return found


def side_by_side(
    scale: Scale,
    folder: Path,
    system: System,
    bridge: str,
    message: Sample,
    ros: RosEnd,
    variants: Sequence[str],
    rates: Sequence[int] = tuple(_RATES),
) -> dict[str, Any]:
    """Measures variants of one bridge; returns figures by rate, way and variant."""
    with Children(system.environment(), folder / "processes.log") as children:
        routes = [Loop(each, ros, system, bridge, message) for each in variants]
        for route in routes:
            route.start(children, folder)
        routes = reached(routes, Loop.reach)
        settle(routes)
        paths = [(route, way) for route in routes for way in WAYS]
        usual = {(route, way): _usual(route, way) for route, way in paths}
        found = {}
        gc.disable()
        for rate in rates:
            fast, slow = _sorted(paths, usual, rate)
            blocks = {way: Blocks() for way in WAYS}
            count = scale.count(_RATES[rate], 10)
            (_bursts if rate >= 1000 else _rounds)(fast, blocks, rate, count)
            _unpaced(slow, blocks, min(count, _MOST_SLOW))
            found[str(rate)] = {way: each.summary() for way, each in blocks.items()}
            for route, way in slow:
                found[str(rate)][way].setdefault(route.variant, {})["too_slow"] = True
            gc.collect()
        gc.enable()
        for route in routes:
            route.close()
    print(f"  {bridge}, {message.kind}: {_told(found)}", flush=True)
    return found


def _usual(route: Loop, way: str) -> float:
    """Returns about how many seconds an exchange takes."""
    times = sorted(route.exchange(way) or 1e6 for _ in range(5))
    return times[2] / 1e6


def _sorted(
    paths: list[_Path], usual: dict[_Path, float], rate: int
) -> tuple[list[_Path], list[_Path]]:
    """Returns the paths that can keep a rate, and the others."""
    if rate >= 1000:
        return [each for each in paths if usual[each] < 1 / rate], [
            each for each in paths if usual[each] >= 1 / rate
        ]
    slow: list[_Path] = []
    fast = sorted(paths, key=usual.__getitem__)
    while fast and sum(usual[each] for each in fast) > _SHARE / rate:
        slow.append(fast.pop())
    return fast, slow


def _rounds(paths: list[_Path], blocks: dict[str, Blocks], rate: int, count: int) -> None:
    """Exchanges a message of each path in each period."""
    order = list(paths)
    due = time.perf_counter()
    for number in range(count):
        if number % max(count // _BLOCKS, 1) == 0:
            random.shuffle(order)
            for each in blocks.values():
                each.begin()
        for place, (route, way) in enumerate(order):
            _sleep_until(due + place / (len(order) * rate))
            blocks[way].add(route.variant, route.exchange(way))
        due = max(due + 1 / rate, time.perf_counter())


def _bursts(paths: list[_Path], blocks: dict[str, Blocks], rate: int, count: int) -> None:
    """Exchanges messages of one path after the other, at a rate."""
    order = list(paths)
    each_time = max(count // _BLOCKS, 2)
    for _ in range(min(_BLOCKS, count // each_time)):
        random.shuffle(order)
        for each in blocks.values():
            each.begin()
        for route, way in order:
            due = time.perf_counter()
            end = due + _CAP
            for number in range(each_time):
                taken = route.exchange(way)
                if number:  # the first one of a burst comes after a pause
                    blocks[way].add(route.variant, taken)
                due += 1 / rate
                _sleep_until(due)
                if time.perf_counter() > end:
                    break


def _unpaced(paths: list[_Path], blocks: dict[str, Blocks], count: int) -> None:
    """Exchanges messages of what is too slow for the rate, as fast as it goes."""
    for route, way in paths:
        end = time.perf_counter() + 1.0
        for _ in range(count):
            blocks[way].add(route.variant, route.exchange(way))
            if time.perf_counter() > end:
                break


def _sleep_until(moment: float) -> None:
    left = moment - time.perf_counter()
    if left > 0:
        time.sleep(left)


def _told(found: dict[str, Any]) -> str:
    told = []
    for rate, ways in found.items():
        for way, variants in ways.items():
            ratio = variants.get(GENERATED, {}).get("ratio")
            told.append(f"{rate}/s {way} {ratio}")
    return ", ".join(told)
