"""Checks a system, and says what was found in words."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.language.model import Diagnostic
from jausml.language.validation.allowances import settled
from jausml.language.validation.rules import PRODUCT_RULES
from jausml.model_checking.search import Bounds, explore, violations
from jausml.model_checking.systems import subjects_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml.language.metamodel.classes import system
    from jausml.language.model import Model
    from jausml.language.validation.rule import SetAside
    from jausml.model_checking.search import Graph, Step, Violation
    from jausml.model_checking.systems import Subject

BOUND_MET = "JML935"


@dataclass(frozen=True)
class Moment:
    """A step of a counter-example.

    Attributes:
        seconds: When it happens, at the earliest, after the start.
    """

    seconds: float
    step: Step
    note: str = ""


@dataclass(frozen=True)
class CounterExample:
    """How a property comes not to hold (`repeats`: how many moments at the end go on for ever)."""

    rule: str
    message: str
    moments: tuple[Moment, ...] = ()
    repeats: int = 0


@dataclass(frozen=True)
class Outcome:
    """What was found of one subject."""

    subject: Subject
    states: int
    transitions: int
    found: tuple[CounterExample, ...]
    allowed: tuple[SetAside, ...] = ()

    @property
    def is_complete(self) -> bool:
        """Whether all states were searched."""
        return all(each.rule != BOUND_MET for each in self.found)


def check_system(
    system_: system.System,
    states: int,
    is_over: Callable[[], bool],
    demanded: float = 0.0,
) -> list[Outcome]:
    """Checks all that there is to check of a system."""
    bounds = Bounds(states, is_over)
    return [check_subject(each, bounds) for each in subjects_of(system_, demanded)]


def without_allowed(outcomes: Iterable[Outcome], model: Model) -> list[Outcome]:
    """Returns outcomes in which what an `@allow` of the model is about does not count."""
    settled_outcomes = []
    for each in outcomes:
        told = {diagnostic_of(each.subject, found, model): found for found in each.found}
        _, aside = settled(model, list(told), PRODUCT_RULES)
        allowed = {one.diagnostic for one in aside}
        found = tuple(example for one, example in told.items() if one not in allowed)
        settled_outcomes.append(replace(each, found=found, allowed=tuple(aside)))
    return settled_outcomes


def diagnostic_of(subject: Subject, example: CounterExample, model: Model) -> Diagnostic:
    """Returns what was found as a finding at the element that it is about."""
    steps = "; ".join(
        f"{each.seconds:g} s {each.step.actor}: {each.step.what}" for each in example.moments
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
    """Searches one product and judges it."""
    graph = explore(subject.product, bounds)
    found = [_told(subject, graph, each) for each in violations(subject.product, graph)]
    if not graph.is_complete:
        told = f"only {len(graph.states)} states were searched"
        found.append(CounterExample(BOUND_MET, told))
    transitions = sum(map(len, graph.edges))
    return Outcome(subject, len(graph.states), transitions, tuple(found))


def _told(subject: Subject, graph: Graph, violation: Violation) -> CounterExample:
    ticks = 0
    moments = []
    for step, _ in violation.way:
        ticks += graph.steps[step].is_tick
        moments.append(Moment(round(ticks * subject.tick, 3), graph.steps[step]))
    bound = f"{subject.product.bound * subject.tick:g} s"
    message = violation.message.replace("{bound}", bound)
    message += "" if moments else ", from the start on"
    return CounterExample(violation.rule, message, tuple(moments), violation.repeats)
