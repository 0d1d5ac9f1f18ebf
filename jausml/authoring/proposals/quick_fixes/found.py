"""Findings as quick fixes look at them, and the quick fixes that many rules share."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

from jausml.authoring.editing.commands import Command, Remove, Set
from jausml.authoring.proposals.elements import Scope, literal, values_of
from jausml.language.metamodel import ClassTable
from jausml.language.model import Diagnostic
from jausml.language.semantics.names import in_words


@dataclass(frozen=True, slots=True)
class QuickFix:
    """Commands by which a finding goes away."""

    label: str
    commands: Sequence[Command]


_QUOTED = re.compile(r"'([^']*)'")


@dataclass(frozen=True)
class Found:
    """A finding at an element of the project."""

    scope: Scope
    element: Any
    diagnostic: Diagnostic

    @property
    def message(self) -> str:
        """The message of the finding."""
        return self.diagnostic.message

    @property
    def hint(self) -> str:
        """The advice of the rule."""
        return self.diagnostic.hint

    @property
    def ref(self) -> str:
        """Names the element."""
        return self.scope.ref(self.element)

    @cached_property
    def table(self) -> ClassTable:
        """The class of the element."""
        return self.scope.model.metamodels.class_of(self.element)

    @cached_property
    def feature(self) -> str:
        """The feature at which the finding points, empty for the element as a whole."""
        unread = self.diagnostic.unread
        if unread is not None and len(unread) == 1:
            return next(iter(unread))
        model, place = self.scope.model, self.diagnostic.location
        if place == model.location(self.element):
            return ""
        names = self.table.features
        return next((name for name in names if model.location(self.element, name) == place), "")

    @cached_property
    def quoted(self) -> list[str]:
        """The words in quotation marks in the message."""
        return _QUOTED.findall(self.message)

    @cached_property
    def meant(self) -> list[str]:
        """The names in the advice of the rule: `did you mean 'x'?`, or several."""
        match = re.fullmatch(r"did you mean (.+)\?", self.hint)
        if match is None:
            return []
        return [word.strip("'") for word in match[1].split(" or ")]

    def set(self, label: str, feature: str, *values: str, element: Any = None) -> QuickFix:
        """Returns the quick fix that gives a feature values; without any it is unset."""
        ref = self.ref if element is None else self.scope.ref(element)
        return QuickFix(label, (Set(ref, feature, values),))


Fixer: TypeAlias = Callable[[Found], Iterator[QuickFix]]
"""Yields the quick fixes of a finding, the best first; none where none is sensible."""


def unset(finding: Found) -> Iterator[QuickFix]:
    """Unsets a feature, so that its default holds."""
    feature = finding.table.features.get(finding.feature)
    if feature is None or (feature.can_be_missing and feature.lower > 0):
        return
    if not values_of(finding.element, feature) and finding.diagnostic.unread is None:
        return
    words = in_words(feature.name)
    default = "" if feature.default is None else literal(feature.default)
    shown = f", which makes it {default}" if default else ""
    yield finding.set(f"leave out {words}{shown}", feature.name)


def unset_where(is_meant: Callable[[Found], bool]) -> Fixer:
    """Unsets a feature, for those findings of a rule that call for it."""
    return lambda finding: unset(finding) if is_meant(finding) else iter(())


def removed(label: str) -> Fixer:
    """Takes the element away."""
    return lambda finding: iter((QuickFix(label, (Remove(finding.ref),)),))


def renamed_as_meant(finding: Found) -> Iterator[QuickFix]:
    """Replaces the text of a feature, or its wrong part, by the intended one."""
    feature = finding.table.features.get(finding.feature)
    if feature is None or feature.is_reference:
        return
    values = [literal(value) for value in values_of(finding.element, feature)]
    if len(values) != 1:
        return
    wrong = next((word for word in reversed(finding.quoted) if word and word in values[0]), "")
    for meant in finding.meant:
        text = _replaced(values[0], wrong, meant) if wrong else meant
        yield finding.set(f"write {meant}", feature.name, text)


def _replaced(text: str, wrong: str, meant: str) -> str:
    """Returns a text with a word in the place of another, each time that it stands there alone."""
    pattern = rf"(?<![A-Za-z0-9_]){re.escape(wrong)}(?![A-Za-z0-9_])"
    return re.sub(pattern, lambda _: meant, text)
