"""Checks of a system, with results as text, as JSON, and as SARIF for code scanning."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from jausml.language.metamodel.classes import system
from jausml.language.model import Diagnostic, Model
from jausml.language.model.model import digests
from jausml.language.validation.allowances import settled
from jausml.language.validation.formats import sarif
from jausml.language.validation.rule import Report, SetAside
from jausml.language.validation.rules import PRODUCT_RULES
from jausml.model_checking.search import Bounds, Graph, Step, Violation, explore, violations
from jausml.model_checking.systems import Subject, subjects_of
from jausml.views.diagrams.writers.sequence import Event, SequenceDiagram

BOUND_MET = "JML935"


@dataclass(frozen=True)
class Moment:
    """A step of a counter-example.

    Attributes:
        seconds: Earliest time after the start.
    """

    seconds: float
    step: Step
    note: str = ""


@dataclass(frozen=True)
class CounterExample:
    """A path to a violation of a property (`repeats`: number of last moments that repeat)."""

    rule: str
    message: str
    moments: tuple[Moment, ...] = ()
    repeats: int = 0


@dataclass(frozen=True)
class Outcome:
    """The outcome of one subject (`states`: number of searched states)."""

    subject: Subject
    states: int
    transitions: int
    found: tuple[CounterExample, ...]
    allowed: tuple[SetAside, ...] = ()

    @property
    def is_complete(self) -> bool:
        """Whether all states were searched."""
        rules = {example.rule for example in self.found}
        return BOUND_MET not in rules.union(aside.diagnostic.rule for aside in self.allowed)


def check_system(
    system_: system.System, states: int, is_over: Callable[[], bool], demanded: float = 0.0
) -> list[Outcome]:
    """Checks all subjects of a system; returns their outcomes."""
    bounds = Bounds(states, is_over)
    return [check_subject(subject, bounds) for subject in subjects_of(system_, demanded)]


def without_allowed(outcomes: Iterable[Outcome], model: Model) -> list[Outcome]:
    """Returns outcomes without the findings that an `@allow` of the model permits."""
    settled_outcomes = []
    for outcome in outcomes:
        examples_by_diagnostic = {
            diagnostic_of(outcome.subject, counterexample, model): counterexample
            for counterexample in outcome.found
        }
        _, aside = settled(model, list(examples_by_diagnostic), PRODUCT_RULES)
        allowed = {allowance.diagnostic for allowance in aside}
        counterexamples = tuple(
            example
            for diagnostic, example in examples_by_diagnostic.items()
            if diagnostic not in allowed
        )
        settled_outcomes.append(replace(outcome, found=counterexamples, allowed=tuple(aside)))
    return settled_outcomes


def diagnostic_of(subject: Subject, example: CounterExample, model: Model) -> Diagnostic:
    """Returns a counter-example as a diagnostic at its element."""
    steps = "; ".join(
        f"{moment.seconds:g} s {moment.step.actor}: {moment.step.what}"
        for moment in example.moments
    )
    return Diagnostic(
        rule=example.rule,
        severity=PRODUCT_RULES[example.rule].severity,
        location=model.location(subject.element, None, 0),
        message=f"{subject.name}: {example.message}" + (f" ({steps})" if steps else ""),
        element=model.element_path(subject.element),
        fragment=model.fragment(subject.element),
    )


def check_subject(subject: Subject, bounds: Bounds) -> Outcome:
    """Searches the product of a subject; returns the violations of its properties."""
    graph = explore(subject.product, bounds)
    counterexamples = [
        _counter_example(subject, graph, violation)
        for violation in violations(subject.product, graph)
    ]
    counterexamples += [CounterExample(BOUND_MET, omission) for omission in graph.omissions]
    transitions = sum(map(len, graph.edges))
    return Outcome(subject, len(graph.states), transitions, tuple(counterexamples))


def _counter_example(subject: Subject, graph: Graph, violation: Violation) -> CounterExample:
    ticks = 0
    moments = []
    for step, _ in violation.way:
        ticks += graph.steps[step].is_tick
        moments.append(Moment(round(ticks * subject.tick, 3), graph.steps[step]))
    bound = f"{subject.product.bound * subject.tick:g} s"
    message = violation.message.replace("{bound}", bound)
    message += "" if moments else ", from the start on"
    return CounterExample(violation.rule, message, tuple(moments), violation.repeats)


def _json(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns the text of a JSON object with all products and their counter-examples."""
    products = [_product(outcome, model) for outcome in outcomes]
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
        "stop": subject.stop or None,
        "found": [_as_data(counter_example) for counter_example in outcome.found],
        "allowed": [
            {"rule": allowance.diagnostic.rule, "reason": allowance.reason}
            for allowance in outcome.allowed
        ],
    }


def _as_data(example: CounterExample) -> dict[str, Any]:
    return {
        "rule": example.rule,
        "message": example.message,
        "repeats": example.repeats,
        "steps": [
            {
                "seconds": moment.seconds,
                "actor": moment.step.actor,
                "what": moment.step.what,
                "receiver": moment.step.receiver or None,
            }
            for moment in example.moments
        ],
    }


def sequence_diagram(subject: Subject, example: CounterExample) -> SequenceDiagram:
    """Returns the events of a counter-example; consecutive steps of time are one event."""
    events: list[Event] = []
    first = len(example.moments) - example.repeats
    for number, moment in enumerate(example.moments):
        step = moment.step
        time = f"{moment.seconds:g} s"
        repeats = bool(example.repeats) and number >= first
        if not step.is_tick:
            events.append(Event(time, step.what, step.actor, step.receiver))
            if step.on_to:
                events.append(Event(time, step.what, step.receiver, step.on_to))
        elif events and not events[-1].sender:
            events[-1] = _passing(time, for_ever=repeats)
        else:
            events.append(_passing(time, for_ever=repeats))
    return SequenceDiagram(f"{subject.name}: {example.rule}", example.message, tuple(events))


def _passing(time: str, *, for_ever: bool) -> Event:
    return Event(time, "time passes, for ever" if for_ever else "time passes")


def _text(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns a line for each subject, and the steps of each counter-example."""
    return "\n".join(line for outcome in outcomes for line in _lines(outcome, model)) + "\n"


def summary(outcomes: Sequence[Outcome]) -> str:
    """Returns the extent and the result of the search, in one line."""
    total = sum(len(outcome.found) for outcome in outcomes)
    states = sum(outcome.states for outcome in outcomes)
    products = f"{len(outcomes)} product{'' if len(outcomes) == 1 else 's'}"
    findings = f"{total or 'no'} finding{'' if total == 1 else 's'}"
    return f"{products}, {states} states: {findings}"


def _lines(outcome: Outcome, model: Model) -> Iterator[str]:
    subject = outcome.subject
    size = f"{outcome.states} states, {outcome.transitions} transitions"
    sound = "holds" if outcome.is_complete else "no finding in what was searched"
    verdict = f"{len(outcome.found)} found" if outcome.found else sound
    yield f"{subject.name}: {verdict} ({size}; {_promise(outcome)})"
    for counter_example in outcome.found:
        location = model.location(subject.element, None, 0)
        severity = PRODUCT_RULES[counter_example.rule].severity.value
        yield f"{location}: {severity} {counter_example.rule} {counter_example.message}"
        yield from _way(counter_example)
    for aside in outcome.allowed:
        yield f"{aside.location}: {aside.diagnostic.rule} is allowed: {aside.reason}"


def _promise(outcome: Outcome) -> str:
    subject = outcome.subject
    if subject.held:
        return f"no stop: {subject.held}"
    if not subject.product.bound:
        return "no time-out"
    within = f"stop within {subject.product.bound * subject.tick:g} s"
    return f"{within}, {subject.stop}" if subject.stop else within


def _way(example: CounterExample) -> Iterator[str]:
    first = len(example.moments) - example.repeats
    for number, moment in enumerate(example.moments):
        if example.repeats and number == first:
            yield "    and again and again:"
        yield f"    {moment.seconds:8.3f} s  {_told_in_line(moment)}"


def _told_in_line(moment: Moment) -> str:
    step = moment.step
    to = f" to {step.receiver}" if step.receiver else ""
    further = f" and on to {step.on_to}" if step.on_to else ""
    return f"{step.actor}: {step.what}{to}{further}"


def _sarif(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns the text of a SARIF log of one run."""
    files = tuple(document.display for document in model.documents if document.is_input)
    diagnostics = [
        diagnostic_of(outcome.subject, counterexample, model)
        for outcome in outcomes
        for counterexample in outcome.found
    ]
    aside = tuple(allowance for outcome in outcomes for allowance in outcome.allowed)
    return sarif.render(Report(model, files, tuple(diagnostics), aside, PRODUCT_RULES))


RENDERERS: Mapping[str, Callable[[Sequence[Outcome], Model], str]] = {
    "text": _text,
    "json": _json,
    "sarif": _sarif,
}
