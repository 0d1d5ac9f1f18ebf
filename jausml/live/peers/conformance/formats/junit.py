"""Reports for build servers: JUnit XML, one test suite for each group."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from jausml.language.validation.formats.suites import Case, Suite, junit_document
from jausml.live.peers.conformance.formats.text import evidence_lines
from jausml.live.peers.conformance.verdicts import Verdict

if TYPE_CHECKING:
    from jausml.live.peers.conformance.check import ConformanceReport, Result


def render(report: ConformanceReport) -> str:
    """Returns an XML document that build servers read as test results."""
    # Checks that are left for the end stand with their group.
    places = {each.check.group: place for place, each in reversed([*enumerate(report.results)])}
    results = sorted(report.results, key=lambda each: places[each.check.group])
    groups = groupby(results, key=lambda each: each.check.group)
    suites = (Suite(group, [_case(group, each) for each in results]) for group, results in groups)
    return junit_document(f"JAUS {report.target}", suites)


def _case(group: str, result: Result) -> Case:
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
