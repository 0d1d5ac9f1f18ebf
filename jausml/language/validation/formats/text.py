"""Reports for people and editors: one line for each finding, as compilers write it."""

from __future__ import annotations

from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.validation.rule import Ground, Report


def render(report: Report) -> str:
    """Returns the findings, each on one line, with lines for related places after it."""
    return "".join(
        f"{line}\n" for diagnostic in report.diagnostics for line in lines_of(diagnostic)
    )


def summary(report: Report) -> str:
    """Returns one line that says how many findings there are, and how many do not count."""
    files = _count(len(report.files), "file")
    counts = [
        _count(report.count(severity), noun)
        for severity, noun in ((Severity.ERROR, "error"), (Severity.WARNING, "warning"))
        if report.count(severity)
    ]
    aside = [
        f"{number} {ground.value}"
        for ground in Ground
        if (number := sum(suppression.ground is ground for suppression in report.set_aside))
    ]
    sentence = f"{', '.join(counts) or 'no problems'} in {files}"
    return "; ".join([sentence, *([", ".join(aside)] if aside else [])])


def lines_of(diagnostic: Diagnostic) -> list[str]:
    """Returns the line of a finding, and one for each related place."""
    notes = (f"{note.location}: note: {note.message}" for note in diagnostic.related)
    return [one_line(str(diagnostic)), *map(one_line, notes)]


def one_line(text: str) -> str:
    """Returns text with everything that could move a terminal's cursor escaped."""
    if text.isprintable():
        return text
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
