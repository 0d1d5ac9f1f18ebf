"""A path through a machine that somebody has stepped, as a test in virtual time."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from jausml.generation.errors import NoSystemError
from jausml.generation.literals import clean, python_string
from jausml.generation.python.layout import layout
from jausml.generation.target import source_of, system_of
from jausml.model_checking.runtime_machines import EMERGENCY_CLIENT
from jausml.model_checking.stepping import SteppingError, walked
from jausml.model_checking.virtual_test import CLIENTS, core_message
from jausml_generators.common.components import plain_components
from jausml_generators.jaus_component.views import ComponentView
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.model import Model
    from jausml.model_checking.service_machine import MachineProduct
    from jausml.model_checking.stepping import Choice, Chosen, SteppedMachine

    _Taken = tuple[Chosen, Choice]

_NO_COMPONENT = "no component of the model has this machine: a test needs one with its service"

_HEAD = '''"""A path through {machine} of {component}, in virtual time.

Conditions of the machine say what was said when the path was stepped.

Run it beside the generated workspace: PYTHONPATH=$(echo ws/* | tr ' ' :) python -m pytest FILE
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
    """Returns a test module that takes a path and holds each state to that of the model.

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
                _CONDITION.format(method=methods[each], name=python_string(each))
                for each in product.own_conditions()
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
        system = system_of(model)
    except NoSystemError as error:
        raise SteppingError(_NO_COMPONENT) from error
    for each in plain_components(system):
        if each.name == product.component:
            return ComponentView(each, system, source_of(model))
    raise SteppingError(_NO_COMPONENT)


def _body(subject: SteppedMachine, view: ComponentView, path: Sequence[_Taken]) -> Iterator[str]:
    product = subject.product
    actors = {name: f"client_{n}" for n, name in enumerate((*product.clients, EMERGENCY_CLIENT), 1)}
    used = {chosen.actor for chosen, _ in path}
    yield "component = Told(world.transport())"
    yield "component.start()"
    for number, (name, variable) in enumerate(actors.items(), 1):
        if name in used:
            address = f"JausAddress(64000, 1, {number})"
            yield f"{variable} = client(world.transport(), {address}, {python_string(name)})"
    yield f"world.run_for({subject.tick!r})"
    for kind, group in groupby(path, key=lambda each: each[1].kind):
        taken = list(group)
        if kind == "time":
            yield f"world.run_for({round(len(taken) * subject.tick, 3)!r})"
            yield _expected(view, product, taken[-1][1])
            continue
        for chosen, choice in taken:
            if kind != "core" and product.own_conditions():
                said = sorted(name for name, holds in chosen.said.items() if holds)
                yield f"component.said = frozenset([{', '.join(map(python_string, said))}])"
            yield _done(view, product, choice, actors.get(chosen.actor, ""))
            yield "world.run_for(0)"
            yield _expected(view, product, choice)


def _done(view: ComponentView, product: MachineProduct, choice: Choice, client: str) -> str:
    if choice.kind == "event":
        raised = next(each for each in view.events if each.name == choice.what)
        return f"component.{raised.method}()"
    if not client:
        return 'component.fail("it is told to")'
    sent = core_message(choice.what, product.services.authorities.get(choice.actor, 0))
    if choice.kind == "message":
        owns = view.message_map.items()
        sent = next(
            f"messages.{own.class_name}()" for each, own in owns if each.name == choice.what
        )
    return f"{client}.send({sent}, component.address)"


def _expected(view: ComponentView, product: MachineProduct, choice: Choice) -> str:
    state = f"component.{_attribute(view, product)}.state"
    return f"assert {state} == {python_string(choice.after.path)}"


def _attribute(view: ComponentView, product: MachineProduct) -> str:
    return next(e.attribute for e in view.state_machines if e.machine.name == product.machine.name)
