"""What becomes of samples: medians, percentiles, ratios with their span over the blocks."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from typing import Any

FLOOR = "floor"


def percentile(values: Sequence[float], share: float) -> float:
    """Returns the smallest value that so much of them do not exceed.

    Args:
        values: At least one.
        share: From 0 to 1.
    """
    ordered = sorted(values)
    return ordered[max(math.ceil(share * len(ordered)) - 1, 0)]


def rounded(value: float) -> float:
    """Returns a value with three digits, or as an integer from 100 on."""
    if value == 0 or not math.isfinite(value):
        return value
    digits = 2 - math.floor(math.log10(abs(value)))
    return round(value, digits) if digits > 0 else float(round(value))


class Blocks:
    """Samples of several variants, in blocks in which all of them took their turns."""

    def __init__(self) -> None:
        self._samples: dict[str, list[list[float]]] = {}
        self._lost: dict[str, int] = {}
        self._count = 0

    def begin(self) -> None:
        """Begins a block."""
        self._count += 1

    def add(self, variant: str, value: float | None) -> None:
        """Adds a sample to the present block.

        Args:
            variant: What was measured.
            value: The sample; None for what did not arrive.
        """
        if value is None:
            self._lost[variant] = self._lost.get(variant, 0) + 1
            return
        blocks = self._samples.setdefault(variant, [])
        blocks.extend([] for _ in range(self._count - len(blocks)))
        blocks[-1].append(value)

    def summary(self, against: str = FLOOR, tail: float = 0.99) -> dict[str, dict[str, Any]]:
        """Returns the figures of each variant.

        `n`, `lost`, `median`, `tail` (the percentile) in the unit of the samples; `ratio` of the
        medians to that of another variant, `span` of the ratios of the blocks, `tail_ratio`.

        Args:
            against: The other variant.
            tail: Which percentile.
        """
        figures_by_variant: dict[str, dict[str, Any]] = {}
        base = self._samples.get(against, [])
        for variant, blocks in self._samples.items():
            values = [value for block in blocks for value in block]
            figures: dict[str, Any] = {
                "n": len(values),
                "lost": self._lost.get(variant, 0),
                "median": rounded(statistics.median(values)),
                "tail": rounded(percentile(values, tail)),
            }
            if base and variant != against:
                figures.update(_ratios(blocks, base, tail))
            figures_by_variant[variant] = figures
        for variant, lost in self._lost.items():
            figures_by_variant.setdefault(variant, {"n": 0, "lost": lost})
        return figures_by_variant


def _ratios(
    blocks: Sequence[Sequence[float]], base: Sequence[Sequence[float]], tail: float
) -> Mapping[str, Any]:
    values = [value for block in blocks for value in block]
    others = [value for block in base for value in block]
    pairs = [
        statistics.median(mine) / statistics.median(others)
        for mine, others in zip(blocks, base, strict=False)
        if mine and others
    ]
    ratio = statistics.median(values) / statistics.median(others)
    return {
        "ratio": round(ratio, 2),
        "span": [round(min(pairs), 2), round(max(pairs), 2)] if pairs else [],
        "tail_ratio": round(percentile(values, tail) / percentile(others, tail), 2),
    }
