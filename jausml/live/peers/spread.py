"""Figures of a measured time: least, median, 99th percentile and greatest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class Spread:
    """How a time was spread, in seconds.

    Attributes:
        p99: What 99 of 100 do not exceed (nearest rank).
    """

    count: int
    least: float
    median: float
    p99: float
    greatest: float

    def milliseconds(self) -> dict[str, float]:
        """Returns the figures by name, in milliseconds with three digits."""
        named = {
            "min": self.least,
            "median": self.median,
            "p99": self.p99,
            "max": self.greatest,
        }
        return {name: round(value * 1e3, 3) for name, value in named.items()}


def spread_of(seconds: Iterable[float]) -> Spread | None:
    """Returns the figures of measured times; None without any."""
    ranked = sorted(seconds)
    if not ranked:
        return None
    return Spread(len(ranked), ranked[0], _ranked(ranked, 0.5), _ranked(ranked, 0.99), ranked[-1])


def _ranked(ranked: list[float], share: float) -> float:
    return ranked[math.ceil(share * len(ranked)) - 1]
