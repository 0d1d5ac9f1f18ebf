"""Reports for build servers: JUnit XML, one test suite for each file."""

from __future__ import annotations

from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Severity
from jausml.language.validation.formats.suites import Case, Suite, junit_document
from jausml.language.validation.formats.text import lines_of, one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.language.model.diagnostics import Diagnostic
    from jausml.language.validation.report import Report


def render(report: Report) -> str:
    """Returns an XML document that build servers read as test results.

    A test case is one rule that has findings in the file; it fails when one of them is an error.
    A file without findings has one test case that passes: an empty suite would read as no test.
    """
    by_file: dict[str, list[Diagnostic]] = {path: [] for path in report.files}
    for each in report.diagnostics:
        by_file.setdefault(each.location.path, []).append(each)
    suites = (_suite(one_line(path), findings) for path, findings in by_file.items())
    return junit_document("jausml validate", suites)


def _suite(path: str, findings: Sequence[Diagnostic]) -> Suite:
    ordered = sorted(findings, key=attrgetter("rule"))
    by_rule = groupby(ordered, key=attrgetter("rule"))
    cases = [_case(path, rule, list(group)) for rule, group in by_rule]
    return Suite(path, cases or [Case(path, "no findings")])


def _case(path: str, rule: str, findings: Sequence[Diagnostic]) -> Case:
    errors = [each for each in findings if each.severity is Severity.ERROR]
    others = _lines(each for each in findings if each.severity is not Severity.ERROR)
    if not errors:
        return Case(path, rule, output=others)
    failure = one_line(errors[0].message)
    return Case(path, rule, failure, kind=rule, details=_lines(errors), output=others)


def _lines(findings: Iterable[Diagnostic]) -> str:
    return "\n".join(line for each in findings for line in lines_of(each))
