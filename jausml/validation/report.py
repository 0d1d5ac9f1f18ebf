"""Reports: what a validation yields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.model.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from jausml.model.model import Model


@dataclass(frozen=True, slots=True)
class Report:
    """All findings about some models.

    Attributes:
        model: The elements that could be read.
        files: The files that were asked for, as the user named them, in the order of checking.
        diagnostics: The findings by file, line, column, rule and message.
    """

    model: Model
    files: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]

    def count(self, severity: Severity) -> int:
        """Returns how many findings are of a severity."""
        return sum(each.severity is severity for each in self.diagnostics)

    @property
    def has_errors(self) -> bool:
        """Whether the models cannot be used."""
        return self.count(Severity.ERROR) > 0

    @property
    def has_warnings(self) -> bool:
        """Whether some findings are warnings."""
        return self.count(Severity.WARNING) > 0
