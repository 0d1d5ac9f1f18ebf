"""Reports for build servers: JUnit XML, one test suite for each group."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import groupby
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import Verdict
from jausml.live.peers.conformance.formats.text import evidence_lines

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.live.peers.conformance.check import ConformanceReport, Result


def render(report: ConformanceReport) -> str:
    """Returns an XML document that build servers read as test results.

    Args:
        report: The report.
    """
    root = _totalled("testsuites", f"JAUS {report.target}", report.results)
    for group, results in groupby(report.results, key=lambda each: each.check.group):
        members = list(results)
        suite = _totalled("testsuite", group, members)
        suite.extend(_case(group, each) for each in members)
        root.append(suite)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _totalled(tag: str, name: str, results: Sequence[Result]) -> ET.Element:
    """Returns an element with the totals of some results."""
    return ET.Element(
        tag,
        tests=str(len(results)),
        failures=str(sum(each.verdict is Verdict.FAIL for each in results)),
        errors="0",
        skipped=str(sum(each.verdict is Verdict.SKIPPED for each in results)),
        time=f"{sum(each.seconds for each in results):.3f}",
        name=_printable(name),
    )


def _case(group: str, result: Result) -> ET.Element:
    name = f"{result.check.id}: {result.check.title}"
    time = f"{result.seconds:.3f}"
    case = ET.Element("testcase", classname=f"jaus.{group}", name=_printable(name), time=time)
    message = _printable("; ".join(result.messages))
    if result.verdict is Verdict.FAIL:
        details = "\n".join([result.check.source, *evidence_lines(result)])
        ET.SubElement(case, "failure", message=message).text = _printable(details)
    elif result.verdict is Verdict.SKIPPED:
        ET.SubElement(case, "skipped", message=message)
    elif message:
        ET.SubElement(case, "system-out").text = f"note: {message}"
    return case


def _printable(text: str) -> str:
    """Returns the text without what XML cannot hold."""
    return "".join(char if char.isprintable() or char == "\n" else "?" for char in text)
