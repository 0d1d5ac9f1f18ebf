"""Rules, findings and reports: a rule is a documented function that yields findings on a model."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.diagnostics import Location, RuleInfo
    from jausml.language.model.model import Model
    from jausml.language.semantics.subject import Subject


@dataclass(frozen=True, slots=True)
class Note:
    """A second element that explains a finding."""

    element: EObject
    message: str
    feature: str | None = None


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding of a rule about one element.

    Attributes:
        message: What is wrong, naming the element.
        severity: How grave it is where that is not what the rule says of its findings: a fault of
            a published service set is one that whoever uses the set cannot fix.
        position: At which of several values of the feature to point, from 0.
    """

    element: EObject
    message: str
    feature: str | None = None
    hint: str = ""
    related: tuple[Note, ...] = ()
    severity: Severity | None = None
    position: int = 0


RuleFunction = Callable[["Subject"], Iterator[Finding]]
"""Looks at all elements that a rule is about and yields what is wrong with them."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule with a stable id.

    Attributes:
        id: `JML` and three digits; an id is never used again for something else.
        is_decision: Whether it asks for a decision of a person, since no tool knows the vehicle.
    """

    id: str
    severity: Severity
    title: str
    check: RuleFunction
    is_decision: bool = False

    @property
    def documentation(self) -> str:
        """What the rule demands and why, with a bad and a good example."""
        return inspect.getdoc(self.check) or ""


def rule(
    rule_id: str, severity: Severity, title: str, *, is_decision: bool = False
) -> Callable[[RuleFunction], Rule]:
    """Makes a rule of a function, whose docstring is the documentation page of the rule."""

    def make(check: RuleFunction) -> Rule:
        return Rule(rule_id, severity, title, check, is_decision)

    return make


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
