"""Reports for build servers: JUnit XML, one test suite for each group."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape, quoteattr

from jausml.peers.conformance.check import Verdict
from jausml.peers.conformance.formats.text import evidence_lines

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.peers.conformance.check import ConformanceReport, Result


def render(report: ConformanceReport) -> str:
    """Returns an XML document that build servers read as test results.

    Args:
        report: The report.
    """
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<testsuites {_counts(report.results)} name={_attribute(f'JAUS {report.target}')}>",
    ]
    for group, results in groupby(report.results, key=lambda each: each.check.group):
        members = list(results)
        lines.append(f"  <testsuite {_counts(members)} name={_attribute(group)}>")
        lines += [line for each in members for line in _case(group, each)]
        lines.append("  </testsuite>")
    lines.append("</testsuites>")
    return "\n".join(lines) + "\n"


def _case(group: str, result: Result) -> Iterator[str]:
    name = _attribute(f"{result.check.id}: {result.check.title}")
    group = _attribute(f"jaus.{group}")
    yield f'    <testcase classname={group} name={name} time="{result.seconds:.3f}">'
    message = _attribute("; ".join(result.messages))
    if result.verdict is Verdict.FAIL:
        details = "\n".join([result.check.source, *evidence_lines(result)])
        yield f"      <failure message={message}>{_text(details)}</failure>"
    elif result.verdict is Verdict.SKIPPED:
        yield f"      <skipped message={message}/>"
    elif result.messages:
        yield f"      <system-out>{_text('note: ' + '; '.join(result.messages))}</system-out>"
    yield "    </testcase>"


def _counts(results: Sequence[Result]) -> str:
    failures = sum(each.verdict is Verdict.FAIL for each in results)
    skipped = sum(each.verdict is Verdict.SKIPPED for each in results)
    seconds = sum(each.seconds for each in results)
    return (
        f'tests="{len(results)}" failures="{failures}" errors="0" skipped="{skipped}" '
        f'time="{seconds:.3f}"'
    )


def _attribute(text: str) -> str:
    return quoteattr(_printable(text))


def _text(text: str) -> str:
    return escape(_printable(text))


def _printable(text: str) -> str:
    """Returns the text without what XML cannot hold."""
    return "".join(char if char.isprintable() or char == "\n" else "?" for char in text)
