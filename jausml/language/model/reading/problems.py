"""Problems found while documents are read; they are placed when all documents are there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import (
    READER_RULES,
    Diagnostic,
    Location,
    Related,
    RuleInfo,
    Severity,
)
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.xmi.parsing import Node

XmlAttribute = tuple[str, str]
"""Namespace URI and local name of an XML attribute."""


class NodePlace(NamedTuple):
    """A place in a document: an element, and perhaps an attribute of it."""

    document: Document
    node: Node
    attribute: XmlAttribute | None = None

    def at(self, attribute: str) -> NodePlace:
        """Returns the place of an attribute of the same element, which has no namespace."""
        return NodePlace(self.document, self.node, ("", attribute))

    @property
    def location(self) -> Location:
        """The place as path, line and column."""
        return self.document.location(self.node, self.attribute)


@dataclass(frozen=True, slots=True)
class _Draft:
    rule: str
    place: NodePlace | Location
    message: str
    hint: str
    related: tuple[Related, ...]
    hides: bool


class Problems:
    """The findings of one run, and which features they concern.

    A feature with a finding is not checked further: one cause is one error.
    """

    def __init__(self, rules: Mapping[str, RuleInfo] = MappingProxyType({})) -> None:
        self._rules = {**READER_RULES, **rules}
        self._drafts: list[_Draft] = []
        self.unread: dict[int, set[str]] = {}

    def report(
        self,
        rule: str,
        place: NodePlace | Location,
        message: str,
        hint: str = "",
        related: tuple[Related, ...] = (),
        *,
        hides: bool = False,
    ) -> None:
        """Reports a finding; its severity is that of the rule.

        Args:
            hides: Whether any feature of the element may have another value than the one written;
                else those alone that are marked as unread.
        """
        self._drafts.append(_Draft(rule, place, message, hint, related, hides))

    def mark_unread(self, obj: EObject, feature: str = "") -> None:
        """Notes that a feature of an element has a finding; without a name, that any may have."""
        self.unread.setdefault(id(obj), set()).add(feature)

    def is_unread(self, obj: EObject, feature: str) -> bool:
        """Tells whether a feature of an element has a finding."""
        return not self.unread.get(id(obj), set()).isdisjoint({feature, ""})

    def diagnostics(self, model: Model) -> list[Diagnostic]:
        """Returns the findings, sorted by place."""
        return sorted(
            self._finish(draft, self._rules[draft.rule].severity, model) for draft in self._drafts
        )

    def _finish(self, draft: _Draft, severity: Severity, model: Model) -> Diagnostic:
        place = draft.place
        obj = None if isinstance(place, Location) else _nearest(place.node)
        unread = self.unread.get(id(obj), set())
        return Diagnostic(
            draft.rule,
            severity,
            place if isinstance(place, Location) else place.location,
            draft.message,
            draft.hint,
            model.element_path(obj) if obj is not None else "",
            model.fragment(obj) if obj is not None else "",
            draft.related,
            # None tells the validation that every feature is in doubt, a set that these alone are.
            None if draft.hides or "" in unread else frozenset(unread),
        )


class Findings:
    """The findings of one import, each once, by the rules of an importer and the reader."""

    def __init__(self, rules: Mapping[str, RuleInfo]) -> None:
        self._rules = {**READER_RULES, **rules}
        self._diagnostics: dict[Diagnostic, None] = {}
        self.has_errors = False

    def report(
        self,
        rule: str,
        place: NodePlace | Location,
        message: str,
        hint: str = "",
        related: tuple[Related, ...] = (),
    ) -> None:
        """Reports a finding; its severity is that of the rule."""
        location = place if isinstance(place, Location) else place.location
        severity = self._rules[rule].severity
        self.has_errors = self.has_errors or severity is Severity.ERROR
        self._diagnostics[Diagnostic(rule, severity, location, message, hint, related=related)] = (
            None
        )

    def diagnostics(self) -> list[Diagnostic]:
        """Returns the findings, sorted by place."""
        return sorted(self._diagnostics)


def _nearest(node: Node | None) -> EObject | None:
    """Returns the model element of an XML element or of the nearest one around it."""
    while node is not None and node.obj is None:
        node = node.parent
    return node.obj if node is not None else None
