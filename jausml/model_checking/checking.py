"""Checks a system, and says what was found in words."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Severity
from jausml.language.model.rules import RuleInfo
from jausml.model_checking.properties import (
    CONTROL,
    DEADLOCK,
    LATE_STOP,
    LIVELOCK,
    violations,
)
from jausml.model_checking.search import Bounds, explore
from jausml.model_checking.systems import subjects_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jausml.language.metamodel.classes import system
    from jausml.model_checking.properties import Violation
    from jausml.model_checking.search import Graph, Step
    from jausml.model_checking.systems import Subject

BOUND_MET = "JML935"

_RULES = {
    DEADLOCK: RuleInfo(
        "product: deadlock",
        "jausml model-check has found a way to a state in which nothing that was asked for can "
        "happen any more, whatever anybody does. States of Failure and Shutdown count as ends.",
    ),
    LIVELOCK: RuleInfo(
        "product: livelock",
        "jausml model-check has found a way on which time goes on for ever and nothing that was "
        "asked for happens, though nobody hinders it: for example, a client that was lost keeps "
        "control that never lapses. Give the component a controlTimeout.",
        Severity.WARNING,
    ),
    LATE_STOP: RuleInfo(
        "product: stop that does not come in time",
        "jausml model-check has found a way on which a command stands longer than it may after its "
        "source was lost. The time is that of --within, else the silenceTimeout of the connection, "
        "else the controlTimeout of who obeys. Bad: `silenceTimeout: 0` and `controlTimeout: 0`. "
        "Good: one of them is above 0.",
    ),
    CONTROL: RuleInfo(
        "product: command outside of control",
        "jausml model-check has found a way on which a command takes effect, or stands, although "
        "its sender has no control, the component is not Ready, or an emergency is set.",
    ),
    BOUND_MET: RuleInfo(
        "product: not searched to the end",
        "jausml model-check has met the bound of --states or --budget: what it has not seen may "
        "be wrong. Raise the bound.",
        Severity.WARNING,
    ),
}

MODEL_CHECK_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
"""The rules of model checking by id."""


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
    """How a property comes not to hold.

    Attributes:
        repeats: How many moments at the end go on for ever.
    """

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
    """Checks all that there is to check of a system.

    Args:
        states: How many states of each product are searched.
        is_over: Tells whether the time is up.
        demanded: Seconds in which each stop is demanded; 0 for what the model says of each.
    """
    bounds = Bounds(states, is_over)
    return [check_subject(each, bounds) for each in subjects_of(system_, demanded)]


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
