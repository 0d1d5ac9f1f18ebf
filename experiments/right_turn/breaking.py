"""Where the loop breaks: the most delay and loss that R bears, found by bisection.

The answer holds between two cells of the sweep. Whether a drive is accepted need not change once
only as delay grows; what is found is one place where it does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from experiments.right_turn.cells import WAYS, Cell, under

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    Row = Mapping[str, Any]

SEEDS = 2
"""Drives of each step of a search."""

RESOLUTION = 1.0
"""A search ends when so many ms or percent are between what holds and what does not."""


def is_accepted(row: Row) -> bool:
    """Returns whether each drive of a cell keeps every bound."""
    return bool(row["accepted"])


def is_safe(row: Row) -> bool:
    """Returns whether no drive of a cell leaves the safe region."""
    return bool(row["most"].get("violation_fraction") == 0.0)


CRITERIA: Mapping[str, Callable[[Row], bool]] = {"accepted": is_accepted, "safe": is_safe}
"""What is looked for, by name."""


class Search:
    """The search for the most delay (ms) of a way, or the most loss (%) of both, that is borne.

    Attributes:
        holds: Most of what was tried and borne; None when nothing was.
        breaks: Least of what was tried and not borne; None when all was.
    """

    def __init__(self, way: str, criterion: str, tried: Mapping[float, Row]) -> None:
        """Begin between the first cell that breaks and the one before.

        Args:
            way: One of `WAYS`, or `loss`.
            criterion: Name of what must hold.
            tried: Cells of the sweep by delay or loss.
        """
        self.holds: float | None = None
        self.breaks: float | None = None
        self._way = way
        self._criterion = criterion
        for amount in sorted(tried):
            if not CRITERIA[criterion](tried[amount]):
                self.breaks = amount
                break
            self.holds = amount

    @property
    def is_open(self) -> bool:
        """Whether the answer is not close enough."""
        if self.holds is None or self.breaks is None:
            return False
        return self.breaks - self.holds > RESOLUTION

    def cell(self) -> Cell:
        """Returns what is to be driven next."""
        amount = self._middle()
        if self._way == "loss":
            conditions = under("both", loss=amount / 100)
        else:
            conditions = under(self._way, delay=amount / 1000)
        name = f"search-{self._way}-{self._criterion}-{amount:g}"
        return Cell(name, conditions, {"group": "search"}, SEEDS)

    def take(self, row: Row) -> None:
        """Takes what came of the cell."""
        if CRITERIA[self._criterion](row):
            self.holds = self._middle()
        else:
            self.breaks = self._middle()

    def result(self) -> dict[str, Any]:
        """Returns the answer, in ms or percent."""
        return {
            "way": self._way,
            "criterion": self._criterion,
            "unit": "%" if self._way == "loss" else "ms",
            "holds": self.holds,
            "breaks": self.breaks,
        }

    def _middle(self) -> float:
        assert self.holds is not None and self.breaks is not None  # noqa: S101, PT018 - is open
        return (self.holds + self.breaks) / 2


def breaking_points(
    rows: Sequence[Row], drive: Callable[[Sequence[Cell]], Sequence[Row]]
) -> list[dict[str, Any]]:
    """Returns how much delay of each way and how much loss R bears.

    Args:
        rows: Cells of the sweep.
        drive: Drives further cells.
    """
    searches = [
        Search(way, criterion, _delays(rows, way)) for way in WAYS for criterion in CRITERIA
    ]
    searches += [Search("loss", criterion, _losses(rows)) for criterion in CRITERIA]
    while any(search.is_open for search in searches):
        going = [search for search in searches if search.is_open]
        for search, row in zip(going, drive([each.cell() for each in going]), strict=True):
            search.take(row)
    return [search.result() for search in searches]


def _delays(rows: Sequence[Row], way: str) -> dict[float, Row]:
    """Returns the cells with delay alone; without any, a way is like the others."""
    found = {}
    for row in rows:
        is_plain = row["group"] == "map" and row["loss_percent"] == 0
        if (is_plain and (way == "both" or row["delay_ms"] == 0)) or row.get("way") == way:
            found[row["delay_ms"]] = row
    return found


def _losses(rows: Sequence[Row]) -> dict[float, Row]:
    return {
        row["loss_percent"]: row for row in rows if row["group"] == "map" and row["delay_ms"] == 0
    }
