"""How much is measured: all, a quick look, or just enough to see that it works."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

ItemT = TypeVar("ItemT")


@dataclass(frozen=True)
class Scale:
    """How much is measured.

    Attributes:
        name: How the data calls it.
        factor: Share of the samples of a full run.
        shortened: Whether lists of cases are cut to their first ones.
    """

    name: str
    factor: float
    shortened: bool

    def count(self, full: int, least: int = 3) -> int:
        """Returns how many samples to take.

        Args:
            full: How many a full run takes.
            least: The fewest.
        """
        return max(round(full * self.factor), least)

    def cases(self, every: Sequence[ItemT], few: int) -> list[ItemT]:
        """Returns which cases to measure.

        Args:
            every: Those of a full run.
            few: How many of them a quick run measures; the least run has the first one alone.
        """
        return list(every[: few if self.factor else 1] if self.shortened else every)


FULL = Scale("full", 1.0, shortened=False)
QUICK = Scale("quick", 0.15, shortened=True)
TINY = Scale("tiny", 0.0, shortened=True)
SCALES = {scale.name: scale for scale in (FULL, QUICK, TINY)}
