"""Reports for programs: one JSON object with a versioned schema."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jausml.live.peers.conformance.verdicts import Verdict

if TYPE_CHECKING:
    from jausml.live.peers.conformance.check import ConformanceReport, Result

SCHEMA = 1
"""Version of the layout; it changes when a reader of the present one would be misled."""


def render(report: ConformanceReport) -> str:
    """Returns a JSON object with `schema`, `target`, `summary` and `checks`."""
    content = {
        "schema": SCHEMA,
        "target": report.target,
        "endpoint": report.endpoint,
        "services": list(report.services),
        "passed": report.passed,
        "interrupted": report.interrupted,
        "summary": {verdict.value: report.count(verdict) for verdict in Verdict},
        "checks": [_result(each) for each in report.results],
    }
    return json.dumps(content, indent=2) + "\n"


def _result(result: Result) -> dict[str, Any]:
    return {
        "id": result.check.id,
        "title": result.check.title,
        "source": result.check.source,
        "explanation": result.check.explanation,
        "verdict": result.verdict.value,
        "messages": list(result.messages),
        "seconds": round(result.seconds, 3),
        "evidence": [{**line._asdict(), "time": round(line.time, 4)} for line in result.evidence],
    }
