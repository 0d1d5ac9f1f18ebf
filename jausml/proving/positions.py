"""Which values of a number are tried: ends, powers of two, halves, and random ones."""

from __future__ import annotations

import random
from collections.abc import Iterator

from jausml.proving.layout import FLOAT, Number

SEED = 5684
"""Begins the random values, so that each run tries the same ones."""

_NEIGHBOURS = 64  # how many neighbours of an end are tried

_LARGEST_USUAL = 400.0  # random floats lie within plus and minus this

_NOTABLE_REALS = (
    0.5,
    1.0,
    1.5,
    2.0,
    3.141592653589793,
    1.5707963267948966,
    6.283185307179586,
    90.0,
    180.0,
)


def positions_of(number: Number, count: int) -> list[int]:
    """Returns positions of values in their order: ends, powers of two, halves, and random ones."""
    total = 1 << number.bits
    if total <= count:
        return list(range(total))
    positions = {index for index in _edge_positions(number, total) if 0 <= index < total}
    draw = random.Random(SEED)
    if number.kind == FLOAT:
        # Of all bits, most are numbers that no quantity has; these are of a usual size.
        usual = (draw.uniform(-_LARGEST_USUAL, _LARGEST_USUAL) for _ in range(count // 2))
        positions.update(number.index(number.bits_of(value)) for value in usual)
    while len(positions) < count:
        positions.add(draw.getrandbits(number.bits))
    return sorted(positions)


def spread_positions(number: Number, count: int) -> list[int]:
    """Returns about so many of these positions, from all over the range."""
    positions = positions_of(number, count)
    return positions[:: max(1, len(positions) // count)]


def _edge_positions(number: Number, total: int) -> Iterator[int]:
    for end in (0, total // 2, total - 1, total // 4, 3 * total // 4):
        yield from range(end - _NEIGHBOURS, end + _NEIGHBOURS + 1)
    for power in range(number.bits):
        for near in (-1, 0, 1):
            yield (1 << power) + near
            yield total - (1 << power) + near
            yield number.index(((1 << power) + near) % total)
    if number.kind == FLOAT:
        for magnitude in _NOTABLE_REALS:
            for sign in (1, -1):
                middle = number.index(number.bits_of(sign * magnitude))
                yield from range(middle - 2, middle + 3)
