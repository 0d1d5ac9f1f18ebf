"""JUnit: suites of cases, as build servers show them, and findings as such cases."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from operator import attrgetter

from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.validation.formats.text import lines_of, one_line
from jausml.language.validation.rule import Report


@dataclass(frozen=True, slots=True)
class Case:
    """A test case. Characters that XML cannot hold are escaped.

    Attributes:
        failure: Why it failed, on one line; None where it did not.
        seconds: How long it took; None where nothing was measured.
    """

    group: str
    name: str
    failure: str | None = None
    kind: str = ""
    details: str = ""
    skipped: str | None = None
    output: str = ""
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Suite:
    """Test cases that belong together."""

    name: str
    cases: Sequence[Case] = field(default=())


def junit_document(name: str, suites: Iterable[Suite]) -> str:
    """Returns suites as an XML document."""
    suites = list(suites)
    root = _totalled("testsuites", name, [case for suite in suites for case in suite.cases])
    for suite in suites:
        element = _totalled("testsuite", suite.name, suite.cases)
        element.extend(_case(case) for case in suite.cases)
        root.append(element)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _totalled(tag: str, name: str, cases: Sequence[Case]) -> ET.Element:
    """Returns an element with the totals of some cases."""
    element = ET.Element(
        tag,
        name=_printable(name),
        tests=str(len(cases)),
        failures=str(sum(case.failure is not None for case in cases)),
        errors="0",
        skipped=str(sum(case.skipped is not None for case in cases)),
    )
    measured = [case.seconds for case in cases if case.seconds is not None]
    if measured:
        element.set("time", f"{sum(measured):.3f}")
    return element


def _case(case: Case) -> ET.Element:
    names = {"classname": _printable(case.group), "name": _printable(case.name)}
    element = ET.Element("testcase", names)
    if case.seconds is not None:
        element.set("time", f"{case.seconds:.3f}")
    if case.failure is not None:
        failure = ET.SubElement(element, "failure", message=_printable(case.failure))
        if case.kind:
            failure.set("type", case.kind)
        failure.text = _printable(case.details)
    if case.skipped is not None:
        ET.SubElement(element, "skipped", message=_printable(case.skipped))
    if case.output:
        ET.SubElement(element, "system-out").text = _printable(case.output)
    return element


def _printable(text: str) -> str:
    """Returns text with all but line breaks and printable characters escaped."""
    return "".join(
        character if character.isprintable() or character == "\n" else ascii(character)[1:-1]
        for character in text
    )


def render(report: Report) -> str:
    """Returns an XML document that build servers read as test results.

    A test case is one rule that has findings in the file; it fails when one of them is an error.
    A file without findings has one test case that passes: an empty suite would read as no test.
    """
    by_file: dict[str, list[Diagnostic]] = {path: [] for path in report.files}
    for diagnostic in report.diagnostics:
        by_file.setdefault(diagnostic.location.path, []).append(diagnostic)
    suites = (_suite(one_line(path), findings) for path, findings in by_file.items())
    return junit_document("jausml", suites)


def _suite(path: str, findings: Sequence[Diagnostic]) -> Suite:
    ordered = sorted(findings, key=attrgetter("rule"))
    by_rule = groupby(ordered, key=attrgetter("rule"))
    cases = [_finding_case(path, rule, list(group)) for rule, group in by_rule]
    return Suite(path, cases or [Case(path, "no findings")])


def _finding_case(path: str, rule: str, findings: Sequence[Diagnostic]) -> Case:
    errors = [finding for finding in findings if finding.severity is Severity.ERROR]
    others = _lines(finding for finding in findings if finding.severity is not Severity.ERROR)
    if not errors:
        return Case(path, rule, output=others)
    failure = one_line(errors[0].message)
    return Case(path, rule, failure, kind=rule, details=_lines(errors), output=others)


def _lines(findings: Iterable[Diagnostic]) -> str:
    return "\n".join(line for finding in findings for line in lines_of(finding))
