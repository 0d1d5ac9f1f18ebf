"""Score sheets as text and as JSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jausml.live.peers.conformance.evidence import Verdict
from jausml.live.peers.conformance.formats import evidence_lines, result_json
from jausml.live.peers.rendering import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.peers.judging.competition import Score, Sheet, Task

SCHEMA = 1
"""Version of the layout of JSON."""

_ID_WIDTH = 36


def task_lines(task: Task) -> Iterator[str]:
    """Yields what a task is."""
    yield task.title
    yield f"  {task.rule}"


def score_lines(score: Score) -> Iterator[str]:
    """Yields what a part was worth; of what lost points, why, and what was sent and seen."""
    check, verdict = score.part.check, score.result.verdict
    points = f"{score.points:g}/{score.part.points:g}"
    mark = {Verdict.FAIL: "LOST", Verdict.SKIPPED: "skip"}.get(verdict, "")
    yield f"  {points:>7} {mark:4} {check.id:{_ID_WIDTH}} {check.title}"
    for message in score.result.messages:
        yield f"               {printable(message)}"
    remarks = (each.text for each in score.result.evidence if each.direction == "remark")
    yield from (f"               {each}" for each in remarks)
    if verdict is Verdict.FAIL:
        yield f"               rule: {check.source}"
        yield from (f"               {line}" for line in evidence_lines(score.result))


def ending(sheet: Sheet) -> Iterator[str]:
    """Yields the points of each task, the sum, and what was not looked at."""
    yield ""
    for task in sheet.tasks:
        yield f"{task.title:40} {sheet.reached(task):6g} of {sheet.possible(task):g}"
    yield summary(sheet)
    for each in sheet.competition.not_covered:
        yield f"not judged: {each}"


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
            {"points": each.points, "of": each.part.points, **result_json(each.result)}
            for each in sheet.of(task)
        ],
    }
