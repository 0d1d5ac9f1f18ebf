"""What was found, for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.validation.rules import PRODUCT_RULES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.model import Model
    from jausml.model_checking.checking import CounterExample, Moment, Outcome


def render(outcomes: Sequence[Outcome], model: Model) -> str:
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
