"""Rules, findings and reports: a rule is a documented function that yields findings on a model."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, TypeAlias

from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Diagnostic, Location, RuleInfo, Severity
from jausml.language.model.model import Model
from jausml.language.semantics.paths.scopes import DIRECTED, Direction, directions_of
from jausml.language.semantics.subject import Subject

Kinds: TypeAlias = "type[EObject | Direction] | tuple[type[EObject], ...]"


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


RuleFunction = Callable[..., Iterator[Finding]]
"""Takes the subject, and the element that it judges where it judges each by itself; yields what is
wrong."""


@dataclass(frozen=True, slots=True)
class Scope:
    """The elements that functions of rules judge one by one.

    Attributes:
        kinds: Classes of elements; empty for a function that looks at the model as a whole.
        needs: The features that it cannot do without (see `Subject.instances`).
        condition: Which elements it judges, of those that were read; all by default.
        within: What it judges in an element; by default, the element itself.
    """

    kinds: tuple[type[EObject], ...] = ()
    needs: frozenset[str] | None = None
    condition: Callable[[Subject, Any], bool] | None = None
    within: Callable[[Subject, Any], Iterable[Any]] | None = None

    def judged(self, subject: Subject, element: EObject) -> Iterable[Any]:
        """Returns the objects to judge in an element of the classes."""
        if not subject.is_read(element, self.needs):
            return ()
        if self.condition is not None and not self.condition(subject, element):
            return ()
        return (element,) if self.within is None else self.within(subject, element)


@dataclass(frozen=True, slots=True)
class Part:
    """A function of a rule, and its scope."""

    check: RuleFunction
    scope: Scope


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """A rule with a stable id.

    Attributes:
        id: `JML` and three digits; an id is never used again for something else.
        parts: Its functions. The first one has its documentation.
        is_decision: Whether it asks for a decision of a person, since no tool knows the vehicle.
    """

    id: str
    severity: Severity
    title: str
    parts: list[Part]
    is_decision: bool = False

    @property
    def documentation(self) -> str:
        """The demand of the rule and its reason, with a bad and a good example."""
        return inspect.getdoc(self.parts[0].check) or ""

    def findings(self, subject: Subject) -> Iterator[Finding]:
        """Yields the findings of the rule in a model."""
        for part in self.parts:
            if not part.scope.kinds:
                yield from part.check(subject)
            for kind in part.scope.kinds:
                for element in subject.instances(kind, part.scope.needs):
                    for judged in part.scope.judged(subject, element):
                        yield from part.check(subject, judged)

    def also(
        self, kinds: Kinds, needs: Iterable[str] | None = None
    ) -> Callable[[RuleFunction], RuleFunction]:
        """Adds a function to the rule, for elements of other classes."""

        def add(check: RuleFunction) -> RuleFunction:
            self.parts.append(_part(check, kinds, needs))
            return check

        return add


def rule(
    rule_id: str,
    title: str,
    *,
    severity: Severity = Severity.ERROR,
    is_decision: bool = False,
    kinds: Kinds = (),
    needs: Iterable[str] | None = None,
    condition: Callable[[Subject, Any], bool] | None = None,
) -> Callable[[RuleFunction], Rule]:
    """Makes a rule of a function, whose docstring is the documentation page of the rule.

    With `kinds` the function takes the subject and one element of these classes (or one direction
    of a map, a stop or a safe value), and judges it by itself. Without, it takes the subject, and
    judges the model as a whole.
    """

    def make(check: RuleFunction) -> Rule:
        part = _part(check, kinds, needs, condition)
        return Rule(rule_id, severity, title, [part], is_decision)

    return make


def _part(
    check: RuleFunction,
    kinds: Kinds,
    needs: Iterable[str] | None,
    condition: Callable[[Subject, Any], bool] | None = None,
) -> Part:
    needed = None if needs is None else frozenset(needs)
    if isinstance(kinds, tuple):
        return Part(check, Scope(kinds, needed, condition))
    if issubclass(kinds, Direction):
        return Part(check, Scope(DIRECTED, needed, condition, directions_of))
    return Part(check, Scope((kinds,), needed, condition))


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
        return sum(diagnostic.severity is severity for diagnostic in self.diagnostics)

    @property
    def has_errors(self) -> bool:
        """Whether the models cannot be used."""
        return self.count(Severity.ERROR) > 0

    @property
    def has_warnings(self) -> bool:
        """Whether some findings are warnings."""
        return self.count(Severity.WARNING) > 0
