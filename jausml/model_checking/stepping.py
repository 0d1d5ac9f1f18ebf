"""One machine, stepped by hand: the possible steps in a state, and a path as a test."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Literal

from jausml.generation.errors import NoSystemError
from jausml.generation.literals import clean, python_string
from jausml.generation.python.layout import layout
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import Model
from jausml.model_checking.runtime_machines import EMERGENCY_CLIENT, core_steps
from jausml.model_checking.search import TIME
from jausml.model_checking.service_machine import Behaving, MachineProduct
from jausml.model_checking.systems import Subject, machine_subjects, service_subjects
from jausml.model_checking.virtual_test import CLIENTS, core_message
from jausml_generators.jaus_component.views import ComponentView, component_views
from jausml_generators.python.names import snake_case

Kind = Literal["message", "event", "core", "time"]


@dataclass(frozen=True)
class Chosen:
    """A step that a user has chosen.

    Attributes:
        said: Values of the user's conditions; missing ones are False.
    """

    actor: str
    what: str
    said: Mapping[str, bool] = field(default_factory=dict)


@dataclass(frozen=True)
class Choice:
    """A possible step in a state.

    Attributes:
        after: The state after it.
        transition: The transition of the machine; None if only the core services act.
        why_not: Why the step has no effect; empty if it has one.
    """

    kind: Kind
    actor: str
    what: str
    after: Behaving
    transition: jaus.Transition | None = None
    why_not: str = ""


@dataclass(frozen=True)
class SteppedMachine:
    """A machine with its component.

    Attributes:
        tick: Seconds of one step of time.
        beside: Machines of the component that may lead the core services elsewhere meanwhile, which
            are not stepped.
    """

    product: MachineProduct
    tick: float
    beside: tuple[str, ...] = ()


class SteppingError(Exception):
    """A path that is not possible; the message has the wrong step, counted from 1."""


def stepped_machine(model: Model, element: jaus.StateMachine) -> SteppedMachine | None:
    """Returns a machine in the first component that has it, else in one of defaults.

    None where the machine stands in no service.
    """
    for component in _components(model, element.eContainer()):
        machine = next(
            (candidate for candidate in component if element in candidate.product.machine.elements),
            None,
        )
        if machine is not None:
            others = (sibling.product.machine for sibling in component if sibling is not machine)
            beside = (
                f"{other.name} of {other.service_name}" for other in others if other.extends_core
            )
            return replace(machine, beside=tuple(beside))
    return None


def _components(model: Model, service: jaus.Service | None) -> Iterator[list[SteppedMachine]]:
    """Yields the machines of each component, and last of a service by itself."""
    for component in model.instances(jaus.Component, library=False):
        if not component.external and not isinstance(component, bridge.Bridge):
            yield list(_stepped(machine_subjects(component)))
    if service is not None:
        yield list(_stepped(service_subjects(service)))


def _stepped(subjects: Iterator[Subject]) -> Iterator[SteppedMachine]:
    for subject in subjects:
        if isinstance(subject.product, MachineProduct):
            yield SteppedMachine(subject.product, subject.tick)


def walked(product: MachineProduct, path: Sequence[Chosen]) -> list[Choice]:
    """Returns the choices along a path from the initial state.

    Raises:
        SteppingError: There is no such step any more, since the machine is another one.
    """
    state, taken = product.initial(), []
    for number, step in enumerate(path, 1):
        offered = choices(product, state, step.said)
        choice = next(
            (
                candidate
                for candidate in offered
                if (candidate.actor, candidate.what) == (step.actor, step.what)
            ),
            None,
        )
        if choice is None:
            raise SteppingError(f"step {number}: {step.actor} has no {step.what} any more")
        taken.append(choice)
        state = choice.after
    return taken


def choices(product: MachineProduct, state: Behaving, said: Mapping[str, bool]) -> Iterator[Choice]:
    """Yields all possible steps in a state, also those without an effect.

    Args:
        said: Values of the user's conditions.
    """
    for event in product.events():
        yield _of_the_machine(product, state, ("event", product.component, event), said)
    for message in product.messages():
        for client in product.clients:
            yield _of_the_machine(product, state, ("message", client, message), said)
    clients = product.clients
    for step, core in core_steps(product.services, state.core, product.component, clients):
        why_not = "" if core != state.core else f"it changes nothing in {_standing(state)}"
        after = next(product.after_core_step(state, step, core, said))
        yield Choice("core", step.actor, step.what, after, why_not=why_not)
    yield Choice("time", TIME.actor, TIME.what, next(product.let_time_pass(state, said)))


def _of_the_machine(
    product: MachineProduct, state: Behaving, of: tuple[Kind, str, str], said: Mapping[str, bool]
) -> Choice:
    kind, actor, trigger = of
    sender = actor if kind == "message" else ""
    if not product.is_obeyed(state, trigger, sender):
        why_not = f"{actor} is not obeyed in {_standing(state)}"
        return Choice(kind, actor, trigger, state, why_not=why_not)
    transition = product.choose(state, trigger, sender, said)
    if transition is None:
        why_not = f"no transition takes it in {state.path.rpartition('.')[2]}"
        return Choice(kind, actor, trigger, state, why_not=why_not)
    _, after = product.step(state, transition, trigger, sender)
    return Choice(kind, actor, trigger, after, transition)


def _standing(state: Behaving) -> str:
    who = f"controlled by {state.core.controller}" if state.core.controller else "not controlled"
    return f"{state.core.status}, {who}"


_Taken = tuple[Chosen, Choice]

_NO_COMPONENT = "no component of the model has this machine: a test needs one with its service"

_HEAD = '''"""A path through {machine} of {component}, in virtual time.

Conditions of the machine say what was said when the path was stepped.

Run it beside what `jausml generate --all` makes:
PYTHONPATH=$(echo ws/* | tr ' ' :) python -m pytest FILE
"""

from jausml_runtime import JausAddress, JausComponent, ServiceIdentity
from jausml_runtime import messages as core
from jausml_runtime.virtual import VirtualWorld
from {package} import messages
from {package}.{package}_base import {base}
'''

_CLASS = '''
class Told({base}):
    """Its conditions are told what to say."""

    said = frozenset()
'''

_CONDITION = """
    def {method}(self, *_):
        return {name} in self.said
"""


def stepped_test(model: Model, subject: SteppedMachine, path: Sequence[Chosen]) -> str:
    """Returns a test module that takes a path and compares each state with that of the model.

    Raises:
        SteppingError: The path cannot be gone, no component of the model has the machine, or
            another machine of it acts meanwhile.
    """
    if subject.beside:
        acting = ", ".join(subject.beside)
        raise SteppingError(f"{acting} may act meanwhile: a test of one machine would not hold")
    product = subject.product
    taken = walked(product, path)
    view = _view(model, product)
    machine = product.machine.name
    names = {"package": view.package, "base": view.base_name, "component": view.name}
    body = _body(subject, view, list(zip(path, taken, strict=True)))
    methods = view.condition_methods
    text = "".join(
        [
            _HEAD.format(machine=clean(machine), **names),
            CLIENTS,
            _CLASS.format(**names),
            *(
                _CONDITION.format(method=methods[condition], name=python_string(condition))
                for condition in product.own_conditions()
            ),
            f"\n\ndef test_a_path_through_{snake_case(machine)}():\n",
            '    """It leads from state to state as it was stepped."""\n',
            "    with VirtualWorld() as world:\n",
            *(f"        {line}\n" for line in body),
        ]
    )
    return layout(text)


def _view(model: Model, product: MachineProduct) -> ComponentView:
    try:
        views = model.derived(component_views)
    except NoSystemError as error:
        raise SteppingError(_NO_COMPONENT) from error
    for view in views:
        if view.component.name == product.component:
            return view
    raise SteppingError(_NO_COMPONENT)


def _body(subject: SteppedMachine, view: ComponentView, path: Sequence[_Taken]) -> Iterator[str]:
    product = subject.product
    actors = {
        name: f"client_{number}"
        for number, name in enumerate((*product.clients, EMERGENCY_CLIENT), 1)
    }
    used = {chosen.actor for chosen, _ in path}
    yield "component = Told(world.transport())"
    yield "component.start()"
    for number, (name, variable) in enumerate(actors.items(), 1):
        if name in used:
            address = f"JausAddress(64000, 1, {number})"
            yield f"{variable} = client(world.transport(), {address}, {python_string(name)})"
    yield f"world.run_for({subject.tick!r})"
    for (kind, said), group in groupby(
        path, key=lambda pair: (pair[1].kind, _said(product, *pair))
    ):
        taken = list(group)
        if said is not None:
            yield f"component.said = frozenset([{', '.join(map(python_string, said))}])"
        # Consecutive steps of time are one run of the world.
        if kind == "time":
            yield f"world.run_for({round(len(taken) * subject.tick, 3)!r})"
            yield _expected(view, product, taken[-1][1])
            continue
        for chosen, choice in taken:
            yield _done(view, product, choice, actors.get(chosen.actor, ""))
            yield "world.run_for(0)"
            yield _expected(view, product, choice)


def _said(product: MachineProduct, chosen: Chosen, choice: Choice) -> tuple[str, ...] | None:
    """Returns the conditions that hold at a step; None where they decide nothing."""
    if not product.own_conditions():
        return None
    # Machines that extend those of the core follow it whatever their conditions say.
    if choice.kind in ("core", "time") and product.machine.extends_core:
        return None
    return tuple(sorted(name for name, holds in chosen.said.items() if holds))


def _done(view: ComponentView, product: MachineProduct, choice: Choice, client: str) -> str:
    if choice.kind == "event":
        raised = next(event for event in view.events if event.name == choice.what)
        return f"component.{raised.method}()"
    if not client:
        return 'component.fail("it is told to")'
    sent = core_message(choice.what, product.services.authorities.get(choice.actor, 0))
    if choice.kind == "message":
        owns = view.message_map.items()
        sent = next(
            f"messages.{own.class_name}()" for message, own in owns if message.name == choice.what
        )
    return f"{client}.send({sent}, component.address)"


def _expected(view: ComponentView, product: MachineProduct, choice: Choice) -> str:
    state = f"component.{_attribute(view, product)}.state"
    return f"assert {state} == {python_string(choice.after.path)}"


def _attribute(view: ComponentView, product: MachineProduct) -> str:
    return next(
        machine_view.attribute
        for machine_view in view.state_machines
        if machine_view.machine.name == product.machine.name
    )
