"""Output formats of conformance reports: one function each, and one line in `RENDERERS`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from jausml.language.validation.formats.junit import Case, Suite, junit_document
from jausml.live.peers.conformance.check import CheckResult, ConformanceReport
from jausml.live.peers.conformance.evidence import Verdict
from jausml.live.peers.rendering import printable

SCHEMA = 1
"""Version of the layout; it changes when a reader of the present one would be misled."""

_WORDS = {Verdict.PASS: "pass", Verdict.FAIL: "FAIL", Verdict.SKIPPED: "skip", Verdict.NOTE: "note"}
_ID_WIDTH = 44
_MARKS = {"sent": ">>", "received": "<<", "remark": "--"}


def render_text(report: ConformanceReport) -> str:
    """Returns the whole report."""
    lines = [*heading(report)]
    group = ""
    for result in report.results:
        if result.check.group != group:
            group = result.check.group
            lines += ["", group]
        lines += result_lines(result)
    lines += ["", summary(report)]
    return "".join(f"{line}\n" for line in lines)


def heading(report: ConformanceReport) -> Iterator[str]:
    """Yields the target and its services."""
    yield f"JAUS conformance of {report.target} at {report.endpoint}"
    if report.services:
        yield f"announces {len(report.services)} services:"
        yield from (f"  {printable(service)}" for service in report.services)
    else:
        yield "announces no services; what answers is checked"


def result_lines(result: CheckResult) -> Iterator[str]:
    """Yields the line of a check, its messages, and the evidence of a failure."""
    yield f"  {_WORDS[result.verdict]}  {result.check.id:{_ID_WIDTH}} {result.check.title}"
    for message in result.messages:
        yield f"          {printable(message)}"
    if result.verdict is Verdict.FAIL:
        yield f"          source: {result.check.source}"
        yield from (f"          {line}" for line in evidence_lines(result))


def evidence_lines(result: CheckResult) -> Iterator[str]:
    """Yields the messages sent (>>) and received (<<), each with its bytes."""
    for line in result.evidence:
        yield f"{line.time:7.3f} {_MARKS[line.direction]} {printable(line.text)}"
        if line.hex:
            yield f"           {line.hex}"


def summary(report: ConformanceReport) -> str:
    """Returns the result in one line."""
    counts = ", ".join(
        f"{report.count(verdict)} {word}"
        for verdict, word in (
            (Verdict.PASS, "passed"),
            (Verdict.NOTE, "passed with a note"),
            (Verdict.FAIL, "failed"),
            (Verdict.SKIPPED, "skipped"),
        )
        if report.count(verdict) or verdict is Verdict.FAIL
    )
    end = " (interrupted)" if report.interrupted else ""
    return f"{len(report.results)} checks: {counts}{end}"


def render_json(report: ConformanceReport) -> str:
    """Returns a JSON object, whose `schema` is a number that changes with its meaning."""
    content = {
        "schema": SCHEMA,
        "target": report.target,
        "endpoint": report.endpoint,
        "services": list(report.services),
        "passed": report.passed,
        "interrupted": report.interrupted,
        "summary": {verdict.value: report.count(verdict) for verdict in Verdict},
        "checks": [result_json(result) for result in report.results],
    }
    return json.dumps(content, indent=2) + "\n"


def result_json(result: CheckResult) -> dict[str, Any]:
    """Returns the outcome of a check as an object."""
    return {
        "id": result.check.id,
        "title": result.check.title,
        "source": result.check.source,
        "explanation": result.check.explanation,
        "verdict": result.verdict.value,
        "messages": list(result.messages),
        "begun": None if result.begun is None else result.begun.isoformat(timespec="milliseconds"),
        "seconds": round(result.seconds, 3),
        "evidence": [{**line._asdict(), "time": round(line.time, 4)} for line in result.evidence],
    }


def render_junit(report: ConformanceReport) -> str:
    """Returns an XML document that build servers read as test results."""
    # Risky checks run last; here they stand with the others of their group.
    by_group: dict[str, list[CheckResult]] = {}
    for result in report.results:
        by_group.setdefault(result.check.group, []).append(result)
    suites = (
        Suite(group, [_case(group, result) for result in results])
        for group, results in by_group.items()
    )
    return junit_document(f"JAUS {report.target}", suites)


def _case(group: str, result: CheckResult) -> Case:
    message = "; ".join(result.messages)
    details = "\n".join([result.check.source, *evidence_lines(result)])
    is_failure = result.verdict is Verdict.FAIL
    is_skipped = result.verdict is Verdict.SKIPPED
    return Case(
        f"jaus.{group}",
        f"{result.check.id}: {result.check.title}",
        failure=message if is_failure else None,
        details=details if is_failure else "",
        skipped=message if is_skipped else None,
        output=f"note: {message}" if message and not (is_failure or is_skipped) else "",
        seconds=result.seconds,
    )


RENDERERS: Mapping[str, Callable[[ConformanceReport], str]] = {
    "text": render_text,
    "json": render_json,
    "junit": render_junit,
}
"""The functions that render a report, by the name of the format."""
