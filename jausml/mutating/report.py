"""Reports of campaigns: the matrix of what noticed mutations, and what survives."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.mutating.outcomes import VERDICTS, Campaign, Outcome
from jausml.views import pages

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
    """Returns what survived, and what of the generated files it changes."""
    more = len(survivor.files) - _MOST_FILES
    files = ", ".join(survivor.files[:_MOST_FILES]) + (f" and {more} more" if more > 0 else "")
    reason = f"; {survivor.detail}" if survivor.detail else ""
    return f"{survivor.operator}: {survivor.place} {survivor.change} (changes {files}{reason})"


def matrix_rows(campaign: Campaign) -> Iterator[tuple[str, list[int]]]:
    """Yields how many mutations of each operator were noticed by what, and of all of them."""
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
