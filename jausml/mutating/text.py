"""Campaigns as text: the matrix, and what survives."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.mutating.outcomes import NOTICED_BY

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.mutating.outcomes import Campaign, Outcome

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
