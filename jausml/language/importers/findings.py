"""Findings of importers, whose places are in the files that they read."""

from __future__ import annotations

from collections.abc import Mapping

from jausml.language.model.diagnostics import (
    READER_RULES,
    Diagnostic,
    Location,
    Related,
    RuleInfo,
    Severity,
)
from jausml.language.model.reading.problems import NodePlace


class ImportFindings:
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
        diagnostic = Diagnostic(
            rule=rule,
            severity=self._rules[rule].severity,
            location=place if isinstance(place, Location) else place.location,
            message=message,
            hint=hint,
            related=related,
        )
        self.has_errors = self.has_errors or diagnostic.severity is Severity.ERROR
        self._diagnostics[diagnostic] = None

    def diagnostics(self) -> list[Diagnostic]:
        """Returns the findings, sorted by place."""
        return sorted(self._diagnostics)
