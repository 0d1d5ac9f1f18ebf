"""Outcomes of mutations: the verdict on each, the table of a campaign, and reports of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from jausml import __version__
from jausml.mutating.operators import OPERATORS
from jausml.views import pages

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
    """The outcome of a mutation.

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
    """The outcomes of the mutations of a model.

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
        """Returns the mutations that nothing noticed."""
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


_MOST_FILES = 3


def render(campaign: Campaign) -> str:
    """Returns a campaign as text."""
    lines = [summary(campaign), "", *_table(campaign)]
    for remark in campaign.remarks:
        lines += ["", f"note: {remark}"]
    survivors = campaign.survivors()
    if survivors:
        lines += ["", "nothing notices:"]
        lines += [f"  {survivor_line(survivor)}" for survivor in survivors]
    return "\n".join(lines)


def summary(campaign: Campaign) -> str:
    """Returns how many mutations there are, and how many of those tried survive."""
    tried, survive = len(campaign.outcomes), len(campaign.survivors())
    missing = campaign.chosen - tried
    late = f"; the time was over before {missing} more" if missing else ""
    return (
        f"{campaign.model}: {tried} of {campaign.possible} possible mutations tried{late}; "
        f"nothing notices {survive}"
    )


def survivor_line(survivor: Outcome) -> str:
    """Returns the mutation that survived, and the generated files that it changes."""
    more = len(survivor.files) - _MOST_FILES
    files = ", ".join(survivor.files[:_MOST_FILES]) + (f" and {more} more" if more > 0 else "")
    reason = f"; {survivor.detail}" if survivor.detail else ""
    return f"{survivor.operator}: {survivor.place} {survivor.change} (changes {files}{reason})"


def matrix_rows(campaign: Campaign) -> Iterator[tuple[str, list[int]]]:
    """Yields the numbers of noticed mutations by verdict, for each operator and in all."""
    counts_by_operator = campaign.counts_by_operator()
    for name, counts in counts_by_operator.items():
        yield name, [counts[verdict] for verdict in VERDICTS]
    rows = counts_by_operator.values()
    yield "all", [sum(counts[verdict] for counts in rows) for verdict in VERDICTS]


def _table(campaign: Campaign) -> Iterator[str]:
    table_rows = list(matrix_rows(campaign))
    width = max(len(name) for name, _ in table_rows)
    yield " ".join([" " * width, *(f"{verdict:>8}" for verdict in VERDICTS)]).rstrip()
    for name, counts in table_rows:
        yield " ".join([f"{name:{width}}", *(f"{count or '.':>8}" for count in counts)])


def page(campaign: Campaign) -> str:
    """Returns the page of a campaign."""
    content = {
        "campaign": campaign,
        "summary": summary(campaign),
        "verdicts": list(VERDICTS),
        "rows": [
            [name, *(str(count or "") for count in counts)]
            for name, counts in matrix_rows(campaign)
        ],
        "survivors": list(map(survivor_line, campaign.survivors())),
    }
    return pages.page("jausml.mutating", "campaign", f"Mutations of {campaign.model}", content)
