"""Campaigns as a page: the matrix, what survives, and what noticed each of the others."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from jausml.mutating.outcomes import NOTICED_BY
from jausml.mutating.text import rows, summary, told

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.mutating.outcomes import Campaign

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
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Mutations of {escape(campaign.model)}</title>
<style>{_STYLE}</style>
</head>
<body>
<h1>Mutations</h1>
{chr(10).join(_parts(campaign))}
</body>
</html>
"""


def _parts(campaign: Campaign) -> Iterator[str]:
    yield f"<p>{escape(summary(campaign))}</p>"
    for remark in campaign.remarks:
        yield f"<p>Note: {escape(remark)}</p>"
    yield from _table(
        ["operator", *NOTICED_BY],
        ([name, *(str(each or "") for each in counts)] for name, counts in rows(campaign)),
    )
    yield "<h2>Nothing notices</h2>"
    yield from (f"<p>{escape(told(each))}</p>" for each in campaign.survivors())
    yield "<h2>All mutations</h2>"
    yield from _table(
        ["operator", "place", "change", "noticed by", ""],
        ([o.operator, o.place, o.words, o.noticed_by, o.by] for o in campaign.outcomes),
    )


def _table(head: Iterable[str], body: Iterable[Iterable[str]]) -> Iterator[str]:
    yield "<table>"
    yield f"<tr>{''.join(f'<th>{escape(each)}</th>' for each in head)}</tr>"
    for row in body:
        yield f"<tr>{''.join(f'<td>{escape(each)}</td>' for each in row)}</tr>"
    yield "</table>"
