"""What became of mutations, and the matrix of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.mutating.operators import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Sequence

VALIDATE, GENERATE, TESTS, PROVE = "validate", "generate", "tests", "prove"
CHECK, RUN = "check", "run"
WARNING, EQUAL, NOTHING = "warning", "equal", "nothing"

NOTICED_BY = {
    VALIDATE: "a rule finds an error",
    GENERATE: "nothing can be generated",
    TESTS: "a generated test of the model fails",
    PROVE: "a proof of its map finds what that of the model does not",
    CHECK: "a product check finds a violation that the model does not have",
    RUN: "the command of `--run` fails",
    WARNING: "a rule warns, and nothing else notices it",
    EQUAL: "the same code is generated",
    NOTHING: "it survives",
}
"""What can become of a mutation, in the order in which it is tried; the first one counts."""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutation.

    Attributes:
        noticed_by: A key of `NOTICED_BY`.
        by: The finding or the test that noticed it, or why nothing did.
        files: The generated files that differ.
    """

    operator: str
    place: str
    words: str
    noticed_by: str
    by: str = ""
    files: tuple[str, ...] = ()


@dataclass
class Campaign:
    """What became of the mutations of a model.

    Attributes:
        possible: How many mutations there are.
        chosen: How many of them were to be tried.
        remarks: What of the tests could not take part, and why.
    """

    model: str
    possible: int = 0
    chosen: int = 0
    outcomes: list[Outcome] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    def matrix(self) -> dict[str, Counter[str]]:
        """Returns how many mutations of each operator were noticed by what."""
        names = dict.fromkeys(each.name for each in OPERATORS)
        rows = {name: Counter[str]() for name in names}
        for each in self.outcomes:
            rows[each.operator][each.noticed_by] += 1
        return {name: row for name, row in rows.items() if row}

    def survivors(self) -> Sequence[Outcome]:
        """Returns what nothing noticed."""
        return [each for each in self.outcomes if each.noticed_by == NOTHING]

    def to_json(self) -> dict[str, Any]:
        """Returns all that is known, for programs."""
        return {
            "model": self.model,
            "version": __version__,
            "possible": self.possible,
            "chosen": self.chosen,
            "tried": len(self.outcomes),
            "matrix": {name: dict(row) for name, row in self.matrix().items()},
            "outcomes": [asdict(each) for each in self.outcomes],
            "remarks": self.remarks,
        }
