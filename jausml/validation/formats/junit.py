"""Reports for build servers: JUnit XML, one test suite for each file."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING

from jausml.model.diagnostics import Severity
from jausml.validation.formats.text import lines_of, one_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.model.diagnostics import Diagnostic
    from jausml.validation.report import Report

_CLEAN = "no findings"


def render(report: Report) -> str:
    """Returns an XML document that build servers read as test results.

    A test case is one rule that has findings in the file; it fails when one of them is an error.
    A file without findings has one test case that passes: an empty suite would read as no test.

    Args:
        report: The report.
    """
    by_file: dict[str, list[Diagnostic]] = {path: [] for path in report.files}
    for each in report.diagnostics:
        by_file.setdefault(each.location.path, []).append(each)
    root = ET.Element("testsuites", name="jausml validate")
    for path, findings in by_file.items():
        root.append(_suite(path, findings))
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _suite(path: str, findings: Sequence[Diagnostic]) -> ET.Element:
    name = one_line(path)
    suite = ET.Element("testsuite", name=name)
    ordered = sorted(findings, key=attrgetter("rule"))
    for rule, group in groupby(ordered, key=attrgetter("rule")):
        suite.append(_case(name, rule, list(group)))
    if not findings:
        ET.SubElement(suite, "testcase", classname=name, name=_CLEAN)
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall("testcase/failure"))))
    suite.set("errors", "0")
    return suite


def _case(path: str, rule: str, findings: Sequence[Diagnostic]) -> ET.Element:
    case = ET.Element("testcase", classname=path, name=rule)
    errors = [each for each in findings if each.severity is Severity.ERROR]
    others = [each for each in findings if each.severity is not Severity.ERROR]
    if errors:
        failure = ET.SubElement(case, "failure", type=rule, message=one_line(errors[0].message))
        failure.text = _lines(errors)
    if others:
        ET.SubElement(case, "system-out").text = _lines(others)
    return case


def _lines(findings: Sequence[Diagnostic]) -> str:
    return "\n".join(line for each in findings for line in lines_of(each))
