"""Engine of validation: reads models and runs the rules over them."""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from operator import attrgetter

from jausml.language.metamodel import Metamodels
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EClass, EObject
from jausml.language.model import Diagnostic, Document, ReadResult, Related
from jausml.language.model.model import Model, without_collector
from jausml.language.model.project import Reading
from jausml.language.project import read_project
from jausml.language.semantics.paths.wholes import written
from jausml.language.semantics.subject import Subject, remembering
from jausml.language.validation.allowances import settled
from jausml.language.validation.rule import Finding, Report, Rule, RuleFunction, Scope
from jausml.language.validation.rules import all_rules

_Checks = list[tuple[Rule, RuleFunction]]
"""Functions of rules."""


class RuleError(Exception):
    """A rule failed, which is a fault of jausml and not of the model."""

    def __init__(self, rule: Rule, error: Exception) -> None:
        super().__init__(f"rule {rule.id} ({rule.title}) failed: {type(error).__name__}: {error}")
        self.rule = rule


class SupersededError(Exception):
    """A judgement whose model has changed since: it is no longer wanted."""


def check(
    result: ReadResult,
    rules: Sequence[Rule] | None = None,
    is_wanted: Callable[[], bool] = lambda: True,
) -> Report:
    """Checks a model that was read.

    Args:
        is_wanted: Tells whether somebody still wants to know; it is asked before each element.

    Raises:
        RuleError: A rule failed.
        SupersededError: Nobody wants to know any more.
    """
    rules = all_rules() if rules is None else rules
    # Places and units are asked for by many rules, and computed once for all.
    with without_collector(), remembering():
        subject = Subject(result.model, result.diagnostics)
        findings = [finding for rule in rules for finding in _found_in_whole(subject, rule)]
        judging = _Judging(rules, result.model.metamodels)
        for element in subject.elements():
            if not is_wanted():
                raise SupersededError
            findings += _found_at(subject, element, judging.of(element))
        return _reported(result, rules, _read_well(subject, findings))


class _Judging:
    """Which rules judge elements of a class."""

    def __init__(self, rules: Iterable[Rule], metamodels: Metamodels) -> None:
        self._groups: dict[EClass, dict[Scope, _Checks]] = defaultdict(dict)
        for rule in rules:
            for part in rule.parts:
                classes = {
                    table.eclass
                    for kind in part.scope.kinds
                    for table in metamodels.class_of(kind).subtypes
                }
                for metaclass in classes:
                    checks = self._groups[metaclass].setdefault(part.scope, [])
                    checks.append((rule, part.check))

    def of(self, element: EObject) -> Iterable[tuple[Scope, _Checks]]:
        """Returns the rules that judge an element, by their scope."""
        return self._groups[element.eClass].items()


def _found_in_whole(subject: Subject, rule: Rule) -> list[tuple[Rule, Finding]]:
    """Returns the findings of those parts of a rule that look at the model as a whole."""
    try:
        return [
            (rule, finding)
            for part in rule.parts
            if not part.scope.kinds
            for finding in part.check(subject)
        ]
    # Whatever a rule raises is a fault of jausml, and must tell the rule.
    except Exception as error:
        raise RuleError(rule, error) from error


def _found_at(
    subject: Subject, element: EObject, groups: Iterable[tuple[Scope, _Checks]]
) -> list[tuple[Rule, Finding]]:
    """Returns the findings of rules that judge an element by itself."""
    findings: list[tuple[Rule, Finding]] = []
    for scope, checks in groups:
        rule = checks[0][0]
        try:
            for judged in scope.judged(subject, element):
                for rule, check in checks:
                    for finding in check(subject, judged):
                        findings.append((rule, finding))
        except Exception as error:
            raise RuleError(rule, error) from error
    return findings


def _read_well(
    subject: Subject, findings: Iterable[tuple[Rule, Finding]]
) -> Iterator[tuple[Rule, Finding]]:
    """Yields the findings about features that were read; about whole elements, if all was read.

    What was found in the members of an assignment of a whole stands at what is written.
    """
    for rule, original in findings:
        notes = tuple(replace(note, element=written(note.element)) for note in original.related)
        finding = replace(original, element=written(original.element), related=notes)
        at = None if finding.feature is None else (finding.feature,)
        if subject.is_read(finding.element, at):
            yield rule, finding


def _reported(
    result: ReadResult, rules: Iterable[Rule], rule_findings: Iterable[tuple[Rule, Finding]]
) -> Report:
    """Returns a report on a model that was read, of all that rules have found in it."""
    findings = list(result.diagnostics)
    findings += (_diagnostic(rule, finding, result.model) for rule, finding in rule_findings)
    # Two parts of a rule may find the same.
    sorted_findings = sorted(set(findings), key=attrgetter("sort_key"))
    standing, aside = settled(result.model, sorted_findings, {rule.id for rule in rules})
    files = tuple(document.display for document in result.model.documents if document.is_input)
    return Report(result.model, files, tuple(standing), tuple(aside))


def _diagnostic(rule: Rule, finding: Finding, model: Model) -> Diagnostic:
    return Diagnostic(
        rule=rule.id,
        severity=finding.severity or rule.severity,
        location=model.location(finding.element, finding.feature, finding.position),
        message=finding.message,
        hint=_spelt(finding.hint, model.document_of(finding.element)),
        element=model.element_path(finding.element),
        fragment=model.fragment(finding.element),
        related=tuple(
            Related(model.location(note.element, note.feature), note.message)
            for note in finding.related
        ),
    )


_ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
_IN_TEXT = ", in text "


def _spelt(hint: str, document: Document | None) -> str:
    """Returns a hint in the notation of its file: rules state attributes as XMI has them."""
    general, _, in_text = hint.partition(_IN_TEXT)
    if document is None or document.is_xml:
        return general
    return _ATTRIBUTE.sub(r"\1: \2", f"{general}: {in_text}" if in_text else general)


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
