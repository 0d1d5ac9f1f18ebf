"""Which values of a number are tried: all, or those where translations go wrong and random ones."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from jausml.proving.layout import FLOAT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.proving.layout import Number

SEED = 5684
"""Begins the random values, so that each run tries the same ones."""

_NEAR = 64
"""How many neighbours of an end are tried."""

_USUAL = 400.0
_REALS = (0.5, 1.0, 1.5, 2.0, 3.141592653589793, 1.5707963267948966, 6.283185307179586, 90.0, 180.0)


def directed(number: Number, count: int) -> list[int]:
    """Returns positions of values in their order: ends, powers of two, halves, and random ones.

    Args:
        count: How many positions there are at most, where the number has so many.
    """
    total = 1 << number.bits
    if total <= count:
        return list(range(total))
    found = {each for each in _marked(number, total) if 0 <= each < total}
    draw = random.Random(SEED)
    if number.kind == FLOAT:
        # Of all bits, most are numbers that no quantity has; these are of a usual size.
        usual = (draw.uniform(-_USUAL, _USUAL) for _ in range(count // 2))
        found.update(number.index(number.bits_of(each)) for each in usual)
    while len(found) < count:
        found.add(draw.getrandbits(number.bits))
    return sorted(found)


def some(number: Number, count: int) -> list[int]:
    """Returns about so many of these positions."""
    found = directed(number, count)
    return found[:: max(1, len(found) // count)]


def _marked(number: Number, total: int) -> Iterator[int]:
    for end in (0, total // 2, total - 1, total // 4, 3 * total // 4):
        yield from range(end - _NEAR, end + _NEAR + 1)
    for power in range(number.bits):
        for near in (-1, 0, 1):
            yield (1 << power) + near
            yield total - (1 << power) + near
            yield number.index(((1 << power) + near) % total)
    if number.kind == FLOAT:
        for each in _REALS:
            for sign in (1, -1):
                middle = number.index(number.bits_of(sign * each))
                yield from range(middle - 2, middle + 3)
