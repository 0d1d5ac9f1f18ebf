"""What was found, for code scanning: located at the connection or service in the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.model import Diagnostic
from jausml.language.validation.formats import sarif
from jausml.language.validation.report import Report
from jausml.model_checking.checking import MODEL_CHECK_RULES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.model_checking.checking import CounterExample, Outcome


def render(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns a SARIF log of one run."""
    files = tuple(document.display for document in model.documents if document.given)
    found = [_diagnostic(outcome, each, model) for outcome in outcomes for each in outcome.found]
    return sarif.render(Report(model, files, tuple(found), rules=MODEL_CHECK_RULES))


def _diagnostic(outcome: Outcome, example: CounterExample, model: Model) -> Diagnostic:
    subject = outcome.subject
    steps = "; ".join(
        f"{each.seconds:g} s {each.step.actor}: {each.step.what}" for each in example.moments
    )
    return Diagnostic(
        rule=example.rule,
        severity=MODEL_CHECK_RULES[example.rule].severity,
        location=model.location(subject.element, None, 0),
        message=f"{subject.name}: {example.message}" + (f" ({steps})" if steps else ""),
        element=model.element_path(subject.element),
        fragment=model.fragment(subject.element),
    )
