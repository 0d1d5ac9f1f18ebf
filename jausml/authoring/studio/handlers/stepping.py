"""Requests that step a state machine by hand. They hold no state: the page has the path."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.views.spots import element_shown
from jausml.language.attributes.guards import GuardError
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model
from jausml.model_checking.stepping import (
    Choice,
    Chosen,
    SteppedMachine,
    SteppingError,
    choices,
    stepped_machine,
    stepped_test,
    walked,
)
from jausml.views.diagrams.views.context import Context

_MOST_STEPS = 1000


def _step(
    context: StudioContext, file: str, view: str, path: tuple[Chosen, ...], said: Mapping[str, bool]
) -> dict[str, Any]:
    """Returns the end of a path, and the possible steps there.

    Args:
        said: Values of the user's conditions for these; missing ones are False.
    """
    model, machine = _machine(context, file, view, path)
    try:
        return _end_of_path(Context(model, view, ()), machine, path, said)
    except GuardError as error:
        raise AnswerError(f"a guard cannot be read: {error}") from error


def _end_of_path(
    ids: Context, machine: SteppedMachine, path: tuple[Chosen, ...], said: Mapping[str, bool]
) -> dict[str, Any]:
    """Returns the answer to `_step`; for a path that is not possible, the initial state."""
    product = machine.product
    try:
        taken, fault = walked(product, path), ""
    except SteppingError as error:
        taken, fault = [], str(error)
    state = taken[-1].after if taken else product.initial()
    return {
        "component": product.component,
        "tick": machine.tick,
        "beside": list(machine.beside),
        "conditions": product.own_conditions(),
        "initial": product.initial().path,
        "taken": [_as_json(ids, choice) for choice in taken],
        "fault": fault,
        "state": state.path,
        "status": state.core.status,
        "controller": state.core.controller,
        "choices": [_as_json(ids, choice) for choice in choices(product, state, said)],
    }


def _as_json(ids: Context, choice: Choice) -> dict[str, str]:
    transition = choice.transition
    return {
        "kind": choice.kind,
        "actor": choice.actor,
        "what": choice.what,
        "state": choice.after.path,
        "transition": "" if transition is None else ids.id_of(transition),
        "why_not": choice.why_not,
    }


def _test(context: StudioContext, file: str, view: str, path: tuple[Chosen, ...]) -> dict[str, str]:
    """Returns a path as a test module."""
    if context.verdicts.of(file).report.has_errors:
        raise AnswerError("the model has errors: mend them before a test is made")
    model, machine = _machine(context, file, view, path)
    try:
        return {"test": stepped_test(model, machine, path)}
    except SteppingError as error:
        raise AnswerError(str(error)) from error


def _machine(
    context: StudioContext, file: str, view: str, path: tuple[Chosen, ...]
) -> tuple[Model, SteppedMachine]:
    """Returns the model of a file, and the machine that a view shows, with its component."""
    if len(path) > _MOST_STEPS:
        raise AnswerError(f"a path has {_MOST_STEPS} steps at most")
    scope = context.scope_of(file)
    element = element_shown(scope, view)
    machine = None
    if isinstance(element, jaus.StateMachine):
        machine = stepped_machine(scope.model, element)
    if machine is None:
        raise AnswerError(f"{view} is no view of a machine of a service")
    return scope.model, machine


METHODS: Mapping[str, Callable[..., object]] = {"step": _step, "step.test": _test}
"""The functions that answer questions, by name."""
