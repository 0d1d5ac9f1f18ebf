"""Allowances: what the documentation of an element says of findings that shall not count.

`@allow JML426 until 2027-06-30: the tablet is off at night` in the documentation of an element
is about findings of that rule at the element and at what it owns. Documentation is what XMI and
text both keep, and Eclipse too when it saves.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from datetime import date

from jausml.language.model.diagnostics import READER_RULES, Diagnostic, Location, Severity
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.values import show, suggest
from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.rule import Ground, SetAside
from jausml.language.validation.rules import ALLOWANCE_RULES, PRODUCT_RULES, all_rules

_MARK = "@allow"
_FORM = "write @allow <rule> until <year>-<month>-<day>: <reason>"
_TAG = re.compile(r"@allow\b(?P<said>.*?)(?=@allow\b|\n\s*\n|\Z)", re.DOTALL)
"""Up to an empty line: layouts of text break lines."""
_SAID = re.compile(
    r"\s+(?P<rule>JML\d{3})\s+until\s+(?P<until>\d{4}-\d\d-\d\d)\s*:\s*(?P<why>.+)", re.DOTALL
)


@dataclass(eq=False, slots=True)
class _Allowance:
    """One `@allow`.

    Attributes:
        covered: Fragments of the element and of what it owns: names may stand for several.
    """

    element: str
    fragment: str
    covered: frozenset[str]
    location: Location
    rule: str
    until: date
    reason: str
    used: int = 0
    refused: int = 0

    def is_about(self, diagnostic: Diagnostic) -> bool:
        """Tells whether a finding is of the rule, and at the element or a part of it."""
        return (
            diagnostic.rule == self.rule
            and diagnostic.location.path == self.location.path
            and diagnostic.fragment in self.covered
        )


def settled(
    model: Model,
    diagnostics: Sequence[Diagnostic],
    rules: Collection[str],
    today: date | None = None,
) -> tuple[list[Diagnostic], list[SetAside]]:
    """Returns the findings that count, with those about allowances, and the allowed ones."""
    documents = [document for document in model.documents if _may_allow(document)]
    if not documents:
        return list(diagnostics), []
    day = date.today() if today is None else today
    allowances, findings = _read(documents, model)
    holding = [allowance for allowance in allowances if allowance.until >= day]
    standing, aside = _divided(diagnostics, holding)
    findings += [_expired(allowance) for allowance in allowances if allowance.until < day]
    # Where not all could be read, what is not found says nothing.
    is_whole = not any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)
    looked_at = {*rules, *READER_RULES, *TEXT_RULES}
    input_paths = {document.display for document in documents if document.is_input}
    for allowance in holding:
        is_idle = (
            is_whole and allowance.rule in looked_at and allowance.location.path in input_paths
        )
        if not allowance.used and (allowance.refused or is_idle):
            findings.append(_unused(allowance))
    return sorted([*standing, *findings]), aside


def _may_allow(document: Document) -> bool:
    # Every other byte of UTF-16 is nought.
    return not document.is_library and _MARK.encode() in document.data.replace(b"\0", b"")


def _read(documents: Iterable[Document], model: Model) -> tuple[list[_Allowance], list[Diagnostic]]:
    """Returns the allowances of documents, and what is wrong with how they are written."""
    known = {*(rule.id for rule in all_rules()), *READER_RULES, *TEXT_RULES, *PRODUCT_RULES}
    allowances: list[_Allowance] = []
    faults: list[Diagnostic] = []
    for element in (
        model_element for document in documents for model_element in model.elements_of(document)
    ):
        text = getattr(element, "documentation", None)
        for tag in _TAG.finditer(text) if isinstance(text, str) else ():
            path, fragment = model.element_path(element), model.fragment(element)
            location = model.location(element, "documentation")
            said = _parsed(tag, known)
            if isinstance(said, _Fault):
                of = (path, fragment)
                faults.append(_finding("JML801", location, said.message, said.hint, of))
            else:
                covered = frozenset(map(model.fragment, (element, *element.eAllContents())))
                allowances.append(_Allowance(path, fragment, covered, location, *said))
    return allowances, faults


@dataclass(frozen=True, slots=True)
class _Fault:
    """Why an allowance cannot be read."""

    message: str
    hint: str = _FORM


def _parsed(tag: re.Match[str], known: Collection[str]) -> tuple[str, date, str] | _Fault:
    """Returns rule, last day and reason of an allowance."""
    said = _SAID.fullmatch(tag["said"].rstrip())
    if said is None:
        return _Fault(f"{show(tag[0].strip())} lacks a rule, a day or a reason")
    if said["rule"] not in known:
        return _Fault(f"there is no rule {said['rule']}", suggest(said["rule"], known))
    try:
        return said["rule"], date.fromisoformat(said["until"]), " ".join(said["why"].split())
    except ValueError:
        return _Fault(f"{said['until']} is no day")


def _divided(
    diagnostics: Iterable[Diagnostic], allowances: Sequence[_Allowance]
) -> tuple[list[Diagnostic], list[SetAside]]:
    """Returns the findings that no allowance is about, and the others."""
    standing: list[Diagnostic] = []
    aside: list[SetAside] = []
    for diagnostic in diagnostics:
        about = next(
            (allowance for allowance in allowances if allowance.is_about(diagnostic)), None
        )
        if about is None:
            standing.append(diagnostic)
        elif diagnostic.severity is Severity.ERROR:
            about.refused += 1
            standing.append(diagnostic)
        else:
            about.used += 1
            aside.append(SetAside(diagnostic, Ground.ALLOWED, about.reason, about.location))
    return standing, aside


def _expired(allowance: _Allowance) -> Diagnostic:
    message = (
        f"the allowance of {allowance.rule} ended on {allowance.until}: {show(allowance.reason)}"
    )
    hint = "fix the cause, or write a later day"
    return _finding(
        "JML802", allowance.location, message, hint, (allowance.element, allowance.fragment)
    )


def _unused(allowance: _Allowance) -> Diagnostic:
    message = f"no finding of {allowance.rule} is here that could be allowed"
    hint = "remove the allowance"
    if allowance.refused:
        message, hint = f"{allowance.rule} is an error here, which cannot be allowed", "fix it"
    return _finding(
        "JML803", allowance.location, message, hint, (allowance.element, allowance.fragment)
    )


def _finding(
    rule: str, location: Location, message: str, hint: str, element: tuple[str, str]
) -> Diagnostic:
    return Diagnostic(rule, ALLOWANCE_RULES[rule].severity, location, message, hint, *element)
