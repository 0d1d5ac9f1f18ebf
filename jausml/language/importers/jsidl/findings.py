"""Findings of the importer, each with its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.importers.jsidl.rules import JSIDL_RULES
from jausml.language.model.diagnostics import Diagnostic, Location, Related, Severity
from jausml.language.model.rules import READER_RULES

if TYPE_CHECKING:
    from jausml.language.model.documents import Document
    from jausml.language.model.xmi.parsing import Node


@dataclass(frozen=True, slots=True)
class Place:
    """An element of a JSIDL file, and perhaps one of its attributes."""

    document: Document
    node: Node
    attribute: str = ""

    def at(self, attribute: str) -> Place:
        """Returns the place of an attribute of the same element."""
        return Place(self.document, self.node, attribute)

    @property
    def location(self) -> Location:
        """The place as path, line and column."""
        attribute = ("", self.attribute) if self.attribute else None
        return self.document.location(self.node, attribute)


class Findings:
    """The findings of one import."""

    def __init__(self) -> None:
        self._found: dict[Diagnostic, None] = {}
        self.has_errors = False

    def report(
        self,
        rule: str,
        place: Place | Location,
        message: str,
        hint: str = "",
        related: tuple[Related, ...] = (),
    ) -> None:
        """Reports a finding; its severity is that of the rule.

        A declaration that several messages use is looked at for each of them: what is found there
        again is one finding.
        """
        location = place if isinstance(place, Location) else place.location
        severity = (JSIDL_RULES.get(rule) or READER_RULES[rule]).severity
        self.has_errors = self.has_errors or severity is Severity.ERROR
        self._found[Diagnostic(rule, severity, location, message, hint, related=related)] = None

    def diagnostics(self) -> list[Diagnostic]:
        """Returns the findings, sorted by place."""
        return sorted(self._found)
