"""Outcomes of mutations: the verdict on each, and the table of a campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from jausml import __version__
from jausml.mutating.operators import OPERATORS

Verdict = Literal[
    "validate", "generate", "tests", "prove", "check", "run", "warning", "equal", "nothing"
]

VERDICTS: Mapping[Verdict, str] = {
    "validate": "a rule finds an error",
    "generate": "nothing can be generated",
    "tests": "a generated test of the model fails",
    "prove": "a proof of its map finds what that of the model does not",
    "check": "a product check finds a violation that the model does not have",
    "run": "the command of `--run` fails",
    "warning": "a rule warns, and nothing else notices it",
    "equal": "the same code is generated",
    "nothing": "it survives",
}
"""What verdicts mean, in the order in which they are tried; the first that fits counts.

The last three are not noticed, and of these `nothing` alone makes a survivor: people see a warning,
and equal code is no mistake.
"""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutation.

    Attributes:
        change: What was changed, before and after.
        verdict: What noticed it first, or that nothing did.
        detail: What the one that noticed it says; for a survivor why nothing does, if known.
        files: Generated files that the mutation changes.
    """

    operator: str
    place: str
    change: str
    verdict: Verdict
    detail: str = ""
    files: tuple[str, ...] = ()


@dataclass
class Campaign:
    """What became of the mutations of a model.

    Attributes:
        possible: How many mutations the operators can make.
        chosen: How many of them were to be tried.
        remarks: What of the sound model could not be checked.
    """

    model: str
    possible: int = 0
    chosen: int = 0
    outcomes: list[Outcome] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    def counts_by_operator(self) -> dict[str, Counter[Verdict]]:
        """Returns how many mutations of each operator have which verdict."""
        rows = {operator.name: Counter[Verdict]() for operator in OPERATORS}
        for outcome in self.outcomes:
            rows[outcome.operator][outcome.verdict] += 1
        return {name: row for name, row in rows.items() if row}

    def survivors(self) -> Sequence[Outcome]:
        """Returns what nothing noticed."""
        return [outcome for outcome in self.outcomes if outcome.verdict == "nothing"]

    def to_json(self) -> dict[str, Any]:
        """Returns all that is known, for programs."""
        return {
            "model": self.model,
            "version": __version__,
            "possible": self.possible,
            "chosen": self.chosen,
            "tried": len(self.outcomes),
            "matrix": {name: dict(row) for name, row in self.counts_by_operator().items()},
            "outcomes": [asdict(outcome) for outcome in self.outcomes],
            "remarks": self.remarks,
        }
