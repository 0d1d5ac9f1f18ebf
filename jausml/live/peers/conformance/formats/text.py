"""Reports for people: a line for each check, and the evidence of what is not as it should be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.verdicts import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.peers.conformance.check import ConformanceReport, Result

_WORDS = {
    Verdict.PASS: "pass",
    Verdict.FAIL: "FAIL",
    Verdict.SKIPPED: "skip",
    Verdict.NOTE: "note",
}
_ID_WIDTH = 44
_MARKS = {"sent": ">>", "received": "<<", "remark": "--"}


def render(report: ConformanceReport) -> str:
    """Returns the whole report."""
    lines = [*heading(report.target, report.endpoint, report.services)]
    group = ""
    for each in report.results:
        if each.check.group != group:
            group = each.check.group
            lines += ["", group]
        lines += result_lines(each)
    lines += ["", summary(report)]
    return "".join(f"{line}\n" for line in lines)


def heading(target: str, endpoint: str, services: tuple[str, ...]) -> Iterator[str]:
    """Yields what was tested."""
    yield f"JAUS conformance of {target} at {endpoint}"
    if services:
        yield f"announces {len(services)} services:"
        yield from (f"  {_printable(service)}" for service in services)
    else:
        yield "announces no services; what answers is checked"


def result_lines(result: Result) -> Iterator[str]:
    """Yields the line of a check, its messages, and the evidence of a failure."""
    yield f"  {_WORDS[result.verdict]}  {result.check.id:{_ID_WIDTH}} {result.check.title}"
    for message in result.messages:
        yield f"          {_printable(message)}"
    if result.verdict is Verdict.FAIL:
        yield f"          source: {result.check.source}"
        yield from (f"          {line}" for line in evidence_lines(result))


def evidence_lines(result: Result) -> Iterator[str]:
    """Yields what was sent (>>) and received (<<), each with its bytes."""
    for line in result.evidence:
        yield f"{line.time:7.3f} {_MARKS[line.direction]} {_printable(line.text)}"
        if line.hex:
            yield f"           {line.hex}"


def summary(report: ConformanceReport) -> str:
    """Returns one line that says how it went."""
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


def _printable(text: str) -> str:
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)
