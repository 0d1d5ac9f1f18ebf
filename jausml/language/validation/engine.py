"""Engine of validation: reads models and runs the rules over them."""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model import Diagnostic, Related
from jausml.language.model.model import without_collector
from jausml.language.project import read_project
from jausml.language.semantics.subject import Subject, remembering
from jausml.language.validation.allowances import settled
from jausml.language.validation.rule import Report
from jausml.language.validation.rules import all_rules

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.language.model import ReadResult
    from jausml.language.model.project import Reading
    from jausml.language.validation.rule import Finding, Rule


class RuleError(Exception):
    """A rule failed, which is a fault of jausml and not of the model."""

    def __init__(self, rule: Rule, error: Exception) -> None:
        super().__init__(f"rule {rule.id} ({rule.title}) failed: {type(error).__name__}: {error}")
        self.rule = rule


def check(result: ReadResult, rules: Sequence[Rule] | None = None) -> Report:
    """Checks a model that was read."""
    findings = list(result.diagnostics)
    rules = all_rules() if rules is None else rules
    with without_collector(), remembering():
        subject = Subject(result.model, result.diagnostics)
        for rule in rules:
            findings += _run(rule, subject)
        names = {each.id for each in rules}
        sorted_findings = sorted(set(findings), key=attrgetter("sort_key"))
        standing, aside = settled(result.model, sorted_findings, names)
    files = tuple(document.display for document in result.model.documents if document.given)
    return Report(result.model, files, tuple(standing), tuple(aside))


def _run(rule: Rule, subject: Subject) -> list[Diagnostic]:
    try:
        return list(_diagnostics(rule, subject))
    except Exception as error:
        raise RuleError(rule, error) from error


def _diagnostics(rule: Rule, subject: Subject) -> Iterator[Diagnostic]:
    for finding in rule.check(subject):
        # A finding about an element as a whole needs all of it.
        at = None if finding.feature is None else (finding.feature,)
        if subject.is_read(finding.element, at):
            yield _diagnostic(rule, finding, subject)


def _diagnostic(rule: Rule, finding: Finding, subject: Subject) -> Diagnostic:
    model = subject.model
    return Diagnostic(
        rule=rule.id,
        severity=finding.severity or rule.severity,
        location=model.location(finding.element, finding.feature, finding.position),
        message=finding.message,
        hint=finding.hint,
        element=model.element_path(finding.element),
        fragment=model.fragment(finding.element),
        related=tuple(
            Related(model.location(note.element, note.feature), note.message)
            for note in finding.related
        ),
    )


def check_project(
    paths: Iterable[str | os.PathLike[str]],
    reading: Reading | None = None,
    *,
    is_one: bool = False,
    frequency: float | None = None,
) -> Report:
    """Reads models with all that they refer to, and judges them by all rules.

    Args:
        frequency: Messages each second of every bridge; None for what the models say.
    """
    read = read_project(paths, reading, is_one=is_one)
    if frequency is not None:
        for owner in read.model.instances(bridge.Bridge):
            owner.frequency = frequency
    return check(read)
