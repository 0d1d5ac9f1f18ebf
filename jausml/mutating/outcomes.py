"""What became of mutations: the matrix of them, what survives, as text and as a page."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.mutating.operators import OPERATORS
from jausml.views.pages import page_head

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

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
    """What became of a mutation (`noticed_by`: a key of `NOTICED_BY`)."""

    operator: str
    place: str
    words: str
    noticed_by: str
    by: str = ""
    files: tuple[str, ...] = ()


@dataclass
class Campaign:
    """What became of the mutations of a model."""

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


_MOST_FILES = 3


def render(campaign: Campaign) -> str:
    """Returns a campaign as text."""
    lines = [summary(campaign), "", *_table(campaign)]
    for remark in campaign.remarks:
        lines += ["", f"note: {remark}"]
    survivors = campaign.survivors()
    if survivors:
        lines += ["", "nothing notices:"]
        lines += [f"  {told(each)}" for each in survivors]
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


def told(survivor: Outcome) -> str:
    """Returns what survived, and what of the generated files it changes."""
    more = len(survivor.files) - _MOST_FILES
    files = ", ".join(survivor.files[:_MOST_FILES]) + (f" and {more} more" if more > 0 else "")
    reason = f"; {survivor.by}" if survivor.by else ""
    return f"{survivor.operator}: {survivor.place} {survivor.words} (changes {files}{reason})"


def rows(campaign: Campaign) -> Iterator[tuple[str, list[int]]]:
    """Yields how many mutations of each operator were noticed by what, and of all of them."""
    matrix = campaign.matrix()
    for name, row in matrix.items():
        yield name, [row[each] for each in NOTICED_BY]
    yield "all", [sum(row[each] for row in matrix.values()) for each in NOTICED_BY]


def _table(campaign: Campaign) -> Iterator[str]:
    found = list(rows(campaign))
    wide = max(len(name) for name, _ in found)
    yield " ".join([" " * wide, *(f"{each:>8}" for each in NOTICED_BY)]).rstrip()
    for name, counts in found:
        yield " ".join([f"{name:{wide}}", *(f"{each or '.':>8}" for each in counts)])


_STYLE = """
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; }
body { margin: 2rem auto; max-width: 70rem; padding: 0 1rem; }
table { border-collapse: collapse; }
th, td { border-top: 1px solid #8886; padding: .2rem .6rem; text-align: left; }
td { overflow-wrap: anywhere; vertical-align: top; }
"""


def page(campaign: Campaign) -> str:
    """Returns the page of a campaign."""
    head = page_head(f"Mutations of {campaign.model}", _STYLE)
    return "\n".join([head, *_parts(campaign), "</body>\n</html>\n"])


def _parts(campaign: Campaign) -> Iterator[str]:
    yield f"<p>{escape(summary(campaign))}</p>"
    for remark in campaign.remarks:
        yield f"<p>Note: {escape(remark)}</p>"
    yield from _html_table(
        ["operator", *NOTICED_BY],
        ([name, *(str(each or "") for each in counts)] for name, counts in rows(campaign)),
    )
    yield "<h2>Nothing notices</h2>"
    yield from (f"<p>{escape(told(each))}</p>" for each in campaign.survivors())
    yield "<h2>All mutations</h2>"
    yield from _html_table(
        ["operator", "place", "change", "noticed by", ""],
        ([o.operator, o.place, o.words, o.noticed_by, o.by] for o in campaign.outcomes),
    )


def _html_table(head: Iterable[str], body: Iterable[Iterable[str]]) -> Iterator[str]:
    yield "<table>"
    yield f"<tr>{''.join(f'<th>{escape(each)}</th>' for each in head)}</tr>"
    for row in body:
        yield f"<tr>{''.join(f'<td>{escape(each)}</td>' for each in row)}</tr>"
    yield "</table>"
