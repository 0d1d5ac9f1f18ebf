"""Score sheets as text, as JSON, and as one HTML page that prints on A4."""

from __future__ import annotations

import json
from collections.abc import Iterator
from datetime import timedelta
from html import escape
from typing import Any

from jausml.live.peers.conformance.check import CheckResult
from jausml.live.peers.conformance.evidence import Verdict
from jausml.live.peers.conformance.formats import evidence_lines, result_json
from jausml.live.peers.judging.competition import Score, Sheet, Task
from jausml.live.peers.rendering import printable
from jausml.views.pages import page_head

SCHEMA = 1  # version of the layout of JSON

_ID_WIDTH = 36


def task_lines(task: Task) -> Iterator[str]:
    """Yields the title and the rule of a task."""
    yield task.title
    yield f"  {task.rule}"


def score_lines(score: Score) -> Iterator[str]:
    """Yields the points of a part; for lost points also the rule and the messages."""
    check, verdict = score.part.check, score.result.verdict
    points = f"{score.points:g}/{score.part.points:g}"
    mark = {Verdict.FAIL: "LOST", Verdict.SKIPPED: "skip"}.get(verdict, "")
    yield f"  {points:>7} {mark:4} {check.id:{_ID_WIDTH}} {check.title}"
    for message in score.result.messages:
        yield f"               {printable(message)}"
    remarks = (
        trace_line.text for trace_line in score.result.evidence if trace_line.direction == "remark"
    )
    yield from (f"               {remark}" for remark in remarks)
    if verdict is Verdict.FAIL:
        yield f"               rule: {check.source}"
        yield from (f"               {line}" for line in evidence_lines(score.result))


def ending(sheet: Sheet) -> Iterator[str]:
    """Yields the points of each task, the sum, and what was not judged."""
    yield ""
    for task in sheet.tasks:
        yield f"{task.title:40} {sheet.reached(task):6g} of {sheet.possible(task):g}"
    yield summary(sheet)
    for aspect in sheet.competition.not_covered:
        yield f"not judged: {aspect}"


def summary(sheet: Sheet) -> str:
    """Returns the sum in one line."""
    end = " (interrupted)" if sheet.interrupted else ""
    return f"{'Sum':40} {sheet.reached():6g} of {sheet.possible():g} points{end}"


def render_json(sheet: Sheet) -> str:
    """Returns a JSON object with `schema`, `competition`, `points`, `of` and `tasks`."""
    content = {
        "schema": SCHEMA,
        "competition": sheet.competition.name,
        "source": sheet.competition.source,
        "target": sheet.target,
        "endpoint": sheet.endpoint,
        "begun": sheet.begun.isoformat(timespec="milliseconds"),
        "services": list(sheet.services),
        "points": sheet.reached(),
        "of": sheet.possible(),
        "full": sheet.is_full,
        "interrupted": sheet.interrupted,
        "tasks": [_task_json(sheet, task) for task in sheet.tasks],
        "not_covered": list(sheet.competition.not_covered),
    }
    return json.dumps(content, indent=2) + "\n"


def _task_json(sheet: Sheet, task: Task) -> dict[str, Any]:
    return {
        "task": task.name,
        "title": task.title,
        "rule": task.rule,
        "points": sheet.reached(task),
        "of": sheet.possible(task),
        "parts": [
            {"points": score.points, "of": score.part.points, **result_json(score.result)}
            for score in sheet.of(task)
        ],
    }


_STYLE = """\
:root { color-scheme: light; --ink: #1a1a1a; --line: #c8c8c8; --soft: #555; --lost: #a3261d;
  --given: #1d6b34; }
@page { size: A4; margin: 18mm 15mm; }
body { font: 14px/1.45 system-ui, sans-serif; color: var(--ink); background: #fff;
  margin: 2rem auto; max-width: 54rem; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .3rem; }
h1, h2 { font-weight: 600; break-after: avoid; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .3rem .5rem;
  border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--soft); }
th.points, td.points { text-align: right; white-space: nowrap; width: 5.5rem; }
tr { break-inside: avoid; }
tfoot td { font-weight: 600; border-bottom: 0; }
.lost { color: var(--lost); } .given { color: var(--given); } .soft { color: var(--soft); }
.why { margin: .15rem 0 0; }
pre { font: 11px/1.4 ui-monospace, monospace; margin: .3rem 0 0; white-space: pre-wrap;
  overflow-wrap: anywhere; }
dl { display: grid; grid-template-columns: 9rem 1fr; gap: .15rem .5rem; } dd { margin: 0; }
footer { margin-top: 2.5rem; }
.sign { display: flex; gap: 3rem; margin-top: 3rem; }
.sign span { flex: 1; border-top: 1px solid var(--ink); padding-top: .2rem; color: var(--soft); }
@media print { body { margin: 0; max-width: none; padding: 0; font-size: 11px; }
  details:not([open]) { display: none; } summary { list-style: none; } }
"""
_ARROWS = {"sent": "→", "received": "←", "remark": "·"}


def render_html(sheet: Sheet) -> str:
    """Returns a sheet as an HTML page; it is the same for the same run, except times."""
    return "\n".join(_lines(sheet)) + "\n"


def _lines(sheet: Sheet) -> Iterator[str]:
    yield page_head(f"{sheet.competition.title}: score sheet of {sheet.target}", _STYLE)
    yield f"<dl><dt>Component</dt><dd>{escape(f'{sheet.target} at {sheet.endpoint}')}</dd>"
    begun = sheet.begun.isoformat(" ", timespec="seconds")
    yield f"<dt>Begun</dt><dd>{escape(begun)}</dd>"
    services = escape(", ".join(sheet.services)) or "none announced"
    yield f"<dt>Services</dt><dd>{services}</dd>"
    yield f"<dt>Rules</dt><dd>{escape(sheet.competition.source)}</dd></dl>"
    yield from _sums(sheet)
    for task in sheet.tasks:
        yield from _task(sheet, task)
    if sheet.competition.not_covered:
        yield "<h2>Not judged</h2>\n<ul>"
        yield from (f"<li>{escape(aspect)}</li>" for aspect in sheet.competition.not_covered)
        yield "</ul>"
    yield '<footer><p class="soft">Times are UTC, by the clock of the judge. '
    yield "→ was sent by the judge, ← by the component.</p>"
    yield '<p class="sign"><span>Judge</span><span>Team</span></p></footer>\n</body>\n</html>'


def _sums(sheet: Sheet) -> Iterator[str]:
    yield '<table>\n<thead><tr><th>Task</th><th class="points">Points</th></tr></thead>\n<tbody>'
    for task in sheet.tasks:
        points = _points(sheet.reached(task), sheet.possible(task))
        yield f'<tr><td>{escape(task.title)}</td><td class="points">{points}</td></tr>'
    end = " (interrupted)" if sheet.interrupted else ""
    points = _points(sheet.reached(), sheet.possible())
    yield f'</tbody>\n<tfoot><tr><td>Sum{end}</td><td class="points">{points}</td></tr></tfoot>'
    yield "</table>"


def _points(points: float, of: float) -> str:
    kind = "given" if points == of else "lost"
    return f'<span class="{kind}">{points:g} of {of:g}</span>'


def _task(sheet: Sheet, task: Task) -> Iterator[str]:
    yield f"<h2>{escape(task.title)}</h2>\n<p>{escape(task.rule)}</p>"
    sources = list(dict.fromkeys(task_score.part.check.source for task_score in sheet.of(task)))
    if len(sources) == 1:
        yield f'<p class="soft">{escape(sources[0])}</p>'
    yield "<table>\n<tbody>"
    for score in sheet.of(task):
        points = _points(score.points, score.part.points)
        yield f"<tr><td>{''.join(_part(score, has_source=len(sources) > 1))}</td>"
        yield f'<td class="points">{points}</td></tr>'
    yield "</tbody>\n</table>"


def _part(score: Score, *, has_source: bool) -> Iterator[str]:
    check, result = score.part.check, score.result
    yield f"{escape(check.title)} <small>{escape(check.id)}</small>"
    kind = "soft" if score.points == score.part.points else "lost"
    for message in result.messages:
        yield f'<p class="why {kind}">{escape(message)}</p>'
    if has_source:
        yield f'<p class="why soft">{escape(check.source)}</p>'
    if result.evidence:
        is_open = " open" if result.verdict is Verdict.FAIL else ""
        yield f"<details{is_open}><summary>sent and seen</summary>"
        yield f"<pre>{escape(chr(10).join(_evidence(result)))}</pre></details>"


def _evidence(result: CheckResult) -> Iterator[str]:
    for line in result.evidence:
        time = f"{line.time:.3f}"
        if result.begun is not None:
            at = result.begun + timedelta(seconds=line.time)
            time = at.strftime("%H:%M:%S.%f")[:-3]
        yield f"{time} {_ARROWS[line.direction]} {line.text}"
        if line.hex:
            yield f"             {line.hex}"
