"""Reports: what a validation yields."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model.diagnostics import Location, RuleInfo
    from jausml.language.model.model import Model


class Ground(Enum):
    """Why a finding does not count."""

    ALLOWED = "allowed"
    """The model says so, with a reason and a date."""
    KNOWN = "known"
    """The baseline lists it."""


@dataclass(frozen=True, slots=True)
class SetAside:
    """A finding that does not count.

    Attributes:
        location: Where that is said; None where no place of a model says it.
    """

    diagnostic: Diagnostic
    ground: Ground
    reason: str
    location: Location | None = None


@dataclass(frozen=True, slots=True)
class Report:
    """All findings about some models.

    Attributes:
        rules: Rules of findings about something else than models.
    """

    model: Model
    files: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    set_aside: tuple[SetAside, ...] = ()
    rules: Mapping[str, RuleInfo] = field(default_factory=dict)

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
