"""Collects findings while documents are read, and places them when all of them are there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.model.diagnostics import Diagnostic, Location, Related
from jausml.model.rules import READER_RULES

if TYPE_CHECKING:
    from jausml.model.documents import Document
    from jausml.model.model import Model
    from jausml.model.parsing import Node

Attribute = tuple[str, str]
"""Namespace URI and local name of an XML attribute."""


@dataclass(frozen=True, slots=True)
class _Draft:
    rule: str
    document: Document
    node: Node | None
    attribute: Attribute | None
    message: str
    hint: str
    related: tuple[Related, ...]
    place: Location | None


class Problems:
    """The findings of one run, and which features they concern.

    A feature with a finding is not checked further: one cause is one error.
    """

    def __init__(self) -> None:
        self._drafts: list[_Draft] = []
        self._spoilt: set[tuple[int, str]] = set()

    def at_file(self, rule: str, document: Document, message: str, hint: str = "") -> None:
        """Reports a finding about a file as a whole."""
        self.at_place(rule, document, Location(document.display), message, hint)

    def at_place(
        self, rule: str, document: Document, place: Location, message: str, hint: str = ""
    ) -> None:
        """Reports a finding at a place that no element holds."""
        self._drafts.append(_Draft(rule, document, None, None, message, hint, (), place))

    def at_node(
        self,
        rule: str,
        document: Document,
        node: Node,
        message: str,
        hint: str = "",
        *,
        attribute: Attribute | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        """Reports a finding at an XML element, or at one of its attributes."""
        draft = _Draft(rule, document, node, attribute, message, hint, related, None)
        self._drafts.append(draft)

    def spoil(self, obj: Any, feature: str) -> None:
        """Notes that a feature of an element has a finding."""
        self._spoilt.add((id(obj), feature))

    def is_spoilt(self, obj: Any, feature: str) -> bool:
        """Tells whether a feature of an element has a finding."""
        return (id(obj), feature) in self._spoilt

    def diagnostics(self, model: Model) -> list[Diagnostic]:
        """Returns the findings, sorted by place."""
        return sorted(self._finish(draft, model) for draft in self._drafts)

    def _finish(self, draft: _Draft, model: Model) -> Diagnostic:
        place = draft.place
        if place is None and draft.node is not None:
            place = draft.document.location(draft.node, draft.attribute)
        obj = _nearest(draft.node)
        return Diagnostic(
            draft.rule,
            READER_RULES[draft.rule].severity,
            place or Location(draft.document.display),
            draft.message,
            draft.hint,
            model.element_path(obj) if obj is not None else "",
            model.fragment(obj) if obj is not None else "",
            draft.related,
        )


def _nearest(node: Node | None) -> Any:
    """Returns the model element of an XML element or of the nearest one around it."""
    while node is not None and node.obj is None:
        node = node.parent
    return node.obj if node is not None else None
