"""Formats of what was found: for people, for programs, and for code scanning."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jausml.language.model.model import digests
from jausml.language.validation.formats import sarif
from jausml.language.validation.rule import Report
from jausml.language.validation.rules import PRODUCT_RULES
from jausml.model_checking.checking import diagnostic_of
from jausml.views.diagrams.writers.sequence import Course, Line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from jausml.language.model import Model
    from jausml.model_checking.checking import CounterExample, Moment, Outcome
    from jausml.model_checking.systems import Subject


def _json(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns an object with all products and their counter-examples."""
    products = [_product(each, model) for each in outcomes]
    return json.dumps({"digests": digests(model), "products": products}, indent=2) + "\n"


def _product(outcome: Outcome, model: Model) -> dict[str, Any]:
    subject = outcome.subject
    return {
        "name": subject.name,
        "location": str(model.location(subject.element, None, 0)),
        "states": outcome.states,
        "transitions": outcome.transitions,
        "complete": outcome.is_complete,
        "tick": subject.tick,
        "stop_within": round(subject.product.bound * subject.tick, 3) or None,
        "held": subject.held or None,
        "found": [_found(each) for each in outcome.found],
        "allowed": [{"rule": e.diagnostic.rule, "reason": e.reason} for e in outcome.allowed],
    }


def _found(example: CounterExample) -> dict[str, Any]:
    return {
        "rule": example.rule,
        "message": example.message,
        "repeats": example.repeats,
        "steps": [
            {
                "seconds": each.seconds,
                "actor": each.step.actor,
                "what": each.step.what,
                "receiver": each.step.receiver or None,
            }
            for each in example.moments
        ],
    }


def course_of(subject: Subject, example: CounterExample) -> Course:
    """Returns what happens one after the other; steps of time without anything else are one."""
    lines: list[Line] = []
    first = len(example.moments) - example.repeats
    for number, moment in enumerate(example.moments):
        step = moment.step
        time = f"{moment.seconds:g} s"
        if not step.is_tick:
            lines.append(Line(time, step.what, step.actor, step.receiver))
            if step.on_to:
                lines.append(Line(time, step.what, step.receiver, step.on_to))
        elif lines and not lines[-1].sender:
            lines[-1] = Line(time, lines[-1].text)
        else:
            goes_on = example.repeats and number >= first
            lines.append(Line(time, "time passes, for ever" if goes_on else "time passes"))
    return Course(f"{subject.name}: {example.rule}", example.message, tuple(lines))


def _text(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns a line for each subject, and the steps of each counter-example."""
    return "\n".join(line for each in outcomes for line in _lines(each, model)) + "\n"


def summary(outcomes: Sequence[Outcome]) -> str:
    """Returns what was searched and found, in one line."""
    found = sum(len(each.found) for each in outcomes)
    states = sum(each.states for each in outcomes)
    products = f"{len(outcomes)} product{'' if len(outcomes) == 1 else 's'}"
    findings = f"{found or 'no'} finding{'' if found == 1 else 's'}"
    return f"{products}, {states} states: {findings}"


def _lines(outcome: Outcome, model: Model) -> Iterator[str]:
    subject = outcome.subject
    size = f"{outcome.states} states, {outcome.transitions} transitions"
    verdict = "holds" if not outcome.found else f"{len(outcome.found)} found"
    yield f"{subject.name}: {verdict} ({size}; {_promise(outcome)})"
    for each in outcome.found:
        location = model.location(subject.element, None, 0)
        severity = PRODUCT_RULES[each.rule].severity.value
        yield f"{location}: {severity} {each.rule} {each.message}"
        yield from _way(each)
    for aside in outcome.allowed:
        yield f"{aside.location}: {aside.diagnostic.rule} is allowed: {aside.reason}"


def _promise(outcome: Outcome) -> str:
    subject = outcome.subject
    if subject.held:
        return f"no stop: {subject.held}"
    if not subject.product.bound:
        return "no time-out"
    return f"stop within {subject.product.bound * subject.tick:g} s"


def _way(example: CounterExample) -> Iterator[str]:
    first = len(example.moments) - example.repeats
    for number, moment in enumerate(example.moments):
        if example.repeats and number == first:
            yield "    and again and again:"
        yield f"    {moment.seconds:8.3f} s  {_told(moment)}"


def _told(moment: Moment) -> str:
    step = moment.step
    to = f" to {step.receiver}" if step.receiver else ""
    further = f" and on to {step.on_to}" if step.on_to else ""
    return f"{step.actor}: {step.what}{to}{further}"


def _sarif(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns a SARIF log of one run."""
    files = tuple(document.display for document in model.documents if document.given)
    found = [diagnostic_of(each.subject, one, model) for each in outcomes for one in each.found]
    aside = tuple(one for each in outcomes for one in each.allowed)
    return sarif.render(Report(model, files, tuple(found), aside, PRODUCT_RULES))


RENDERERS: Mapping[str, Callable[[Sequence[Outcome], Model], str]] = {
    "text": _text,
    "json": _json,
    "sarif": _sarif,
}
