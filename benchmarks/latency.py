"""Latency of each way through a bridge, at several rates and with many connections.

The variants take turns: at 10 and 100 messages a second each period has an exchange of every
variant and way, in an order that is shuffled for each block; at 1000 each has short bursts.
"""

from __future__ import annotations

import gc
import random
import time
from contextlib import closing
from pathlib import Path
from typing import Any

from ends import RosEnd
from figures import Blocks
from names import COMPILED, GENERATED, KINDS, VARIANTS, WAYS
from processes import Children
from samples import Sample, sample
from scale import Scale
from systems import MAPS, Measured, System, generate
from variants import Loop, reached, settle

_RATES = {10: 60, 100: 500, 1000: 1000}
"""Messages a second, and how many are measured of each variant and way."""

_BLOCKS = 10
_BURSTS = 1000
"""Messages a second from which on variants cannot share a period."""

_CAP = 0.25
"""Longest burst in seconds."""

_SHARE = 0.6
"""Part of a period that all exchanges of it may take together."""

_SLOW_RATE, _SLOW_BURST = 100, 3
"""At most so many a second, and so many in each block, of what is too slow for its rate."""

_Path = tuple[Loop, str]


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures each kind of message on a bridge of its own.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by kind, rate, way and variant, in microseconds.
    """
    kinds = scale.cases(tuple(KINDS), len(KINDS))
    names = {kind: f"one_{KINDS[kind][0]}" for kind in kinds}
    bridges = {
        f"one_{map_name}": Measured((map_name,))
        for map_name in MAPS
        if f"one_{map_name}" in names.values()
    }
    system = generate(folder, bridges)
    system.compile()
    figures = {}
    with closing(RosEnd("meter")) as ros:
        for kind in kinds:
            message = sample(system.model, kind)
            figures[kind] = side_by_side(scale, folder, system, names[kind], message, ros)
    return figures


def side_by_side(
    scale: Scale, folder: Path, system: System, bridge: str, message: Sample, ros: RosEnd
) -> dict[str, Any]:
    """Measures the variants of one bridge; returns figures by rate, way and variant."""
    with Children(system.environment(), folder / "processes.log") as children:
        routes = [Loop(variant, ros, system, bridge, message) for variant in VARIANTS]
        for route in routes:
            route.start(children, folder)
        routes = reached(routes, Loop.reach)
        settle(routes)
        paths = [(route, way) for route in routes for way in WAYS]
        usual = {(route, way): _usual(route, way) for route, way in paths}
        figures = {}
        gc.disable()
        for rate, messages in _RATES.items():
            slow = _too_slow(usual, rate)
            blocks = {way: Blocks() for way in WAYS}
            count = scale.count(messages, 10)
            (_bursts if rate >= _BURSTS else _rounds)(paths, slow, blocks, rate, count)
            figures[str(rate)] = {way: block.summary() for way, block in blocks.items()}
            for route, way in slow:
                figures[str(rate)][way].setdefault(route.variant, {})["too_slow"] = True
            gc.collect()
        gc.enable()
        for route in routes:
            route.close()
    print(f"  {bridge}, {message.kind}: {_described(figures)}", flush=True)
    return figures


def _usual(route: Loop, way: str) -> float:
    """Returns about how many seconds an exchange takes."""
    return min(route.exchange(way) or 1e6 for _ in range(5)) / 1e6


def _too_slow(usual: dict[_Path, float], rate: int) -> list[_Path]:
    """Returns the paths that cannot keep a rate, or whose turn would leave no time for others."""
    paths = sorted(usual, key=usual.__getitem__)
    if rate >= _BURSTS:
        return [path for path in paths if usual[path] >= 1 / rate]
    slow: list[_Path] = []
    while sum(usual[path] for path in paths) > _SHARE / rate:
        slow.append(paths.pop())
    return slow


def _rounds(
    paths: list[_Path], slow: list[_Path], blocks: dict[str, Blocks], rate: int, count: int
) -> None:
    """Exchanges a message of each path in each period, of slow ones some in each block."""
    order = [candidate for candidate in paths if candidate not in slow]
    due = time.perf_counter()
    for number in range(count):
        if number % max(count // _BLOCKS, 1) == 0:
            random.shuffle(order)
            for block in blocks.values():
                block.begin()
            for path in slow:
                _burst(path, blocks, _SLOW_RATE, _SLOW_BURST)
            due = time.perf_counter()
        for place, (route, way) in enumerate(order):
            _sleep_until(due + place / (len(order) * rate))
            blocks[way].add(route.variant, route.exchange(way))
        due = max(due + 1 / rate, time.perf_counter())


def _bursts(
    paths: list[_Path], _slow: list[_Path], blocks: dict[str, Blocks], rate: int, count: int
) -> None:
    """Exchanges messages of one path after the other, at a rate."""
    order = list(paths)
    each_time = max(count // _BLOCKS, 2)
    for _ in range(min(_BLOCKS, count // each_time)):
        random.shuffle(order)
        for block in blocks.values():
            block.begin()
        for path in order:
            path[0].exchange(path[1])  # what comes after a longer pause does not count
            _burst(path, blocks, rate, each_time)


def _burst(path: _Path, blocks: dict[str, Blocks], rate: int, count: int) -> None:
    """Exchanges some messages of one path, for no longer than `_CAP`."""
    route, way = path
    due = time.perf_counter()
    end = due + _CAP
    for _ in range(count):
        due += 1 / rate
        _sleep_until(due)
        blocks[way].add(route.variant, route.exchange(way))
        if time.perf_counter() > end:
            break


def _sleep_until(moment: float) -> None:
    left = moment - time.perf_counter()
    if left > 0:
        time.sleep(left)


def _described(figures: dict[str, Any]) -> str:
    phrases = []
    for rate, variants_by_way in figures.items():
        for way, variants in variants_by_way.items():
            ratios = [
                str(variants.get(variant, {}).get("ratio")) for variant in (COMPILED, GENERATED)
            ]
            phrases.append(f"{rate}/s {way} {' '.join(ratios)}")
    return ", ".join(phrases)
