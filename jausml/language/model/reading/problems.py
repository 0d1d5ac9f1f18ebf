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


class ReadingProblems:
    """The findings of the reader in one run, and which features they concern.

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
            hides: Whether the finding casts doubt on every feature of the element, so that rules
                look at none of them. Else they leave out those alone that `mark_unread` names,
                before this or after.
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
        unread = self.unread.get(id(obj), set()) if obj is not None else set()
        return Diagnostic(
            rule=draft.rule,
            severity=severity,
            location=place if isinstance(place, Location) else place.location,
            message=draft.message,
            hint=draft.hint,
            element=model.element_path(obj) if obj is not None else "",
            fragment=model.fragment(obj) if obj is not None else "",
            related=draft.related,
            # None tells the validation that every feature is in doubt, a set that these alone are.
            unread=None if draft.hides or "" in unread else frozenset(unread),
        )


def _nearest(node: Node | None) -> EObject | None:
    """Returns the model element of an XML element or of the nearest one around it."""
    while node is not None and node.obj is None:
        node = node.parent
    return node.obj if node is not None else None
