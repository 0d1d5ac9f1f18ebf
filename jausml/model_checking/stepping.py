"""One machine, stepped by hand: what can happen in a state, and where a path leads."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003 - parameters of requests are typed at run time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from jausml.language.metamodel.classes import bridge, jaus
from jausml.model_checking.runtime_machines import core_steps
from jausml.model_checking.search import TIME
from jausml.model_checking.service_machine import MachineProduct
from jausml.model_checking.systems import machine_subjects, service_subjects

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.model import Model
    from jausml.model_checking.service_machine import Behaving
    from jausml.model_checking.systems import Subject

Kind = Literal["message", "event", "core", "time"]


@dataclass(frozen=True)
class Chosen:
    """A step that somebody has chosen.

    Attributes:
        said: What conditions of the user say of it; one that is left out does not hold.
    """

    actor: str
    what: str
    said: Mapping[str, bool] = field(default_factory=dict)


@dataclass(frozen=True)
class Choice:
    """What can happen in a state.

    Attributes:
        after: The state after it.
        transition: What the machine takes; None where the core services alone act.
        why_not: Why nothing happens, empty when something does.
    """

    kind: Kind
    actor: str
    what: str
    after: Behaving
    transition: jaus.Transition | None = None
    why_not: str = ""


@dataclass(frozen=True)
class SteppedMachine:
    """A machine with the component whose it is.

    Attributes:
        tick: Seconds of one step of time.
        beside: Machines of the component that may lead the core services elsewhere meanwhile, which
            are not stepped.
    """

    product: MachineProduct
    tick: float
    beside: tuple[str, ...] = ()


class SteppingError(Exception):
    """A path cannot be gone; the message says at which step, counted from 1."""


def stepped_machine(model: Model, element: jaus.StateMachine) -> SteppedMachine | None:
    """Returns a machine in the first component that has it, else in one that says nothing of it.

    None where the machine stands in no service.
    """
    for component in _components(model, element.eContainer()):
        found = next((e for e in component if element in e.product.machine.elements), None)
        if found is not None:
            others = (e.product.machine for e in component if e is not found)
            beside = (f"{e.name} of {e.service_name}" for e in others if e.extends_core)
            return replace(found, beside=tuple(beside))
    return None


def _components(model: Model, service: jaus.Service | None) -> Iterator[list[SteppedMachine]]:
    """Yields the machines of each component, and last of a service by itself."""
    for each in model.instances(jaus.Component, library=False):
        if not each.external and not isinstance(each, bridge.Bridge):
            yield list(_stepped(machine_subjects(each)))
    if service is not None:
        yield list(_stepped(service_subjects(service)))


def _stepped(subjects: Iterator[Subject]) -> Iterator[SteppedMachine]:
    for each in subjects:
        if isinstance(each.product, MachineProduct):
            yield SteppedMachine(each.product, each.tick)


def walked(product: MachineProduct, path: Sequence[Chosen]) -> list[Choice]:
    """Returns what happens along a path from the initial state.

    Raises:
        SteppingError: There is no such step any more, since the machine is another one.
    """
    state, taken = product.initial(), []
    for number, step in enumerate(path, 1):
        offered = choices(product, state, step.said)
        found = next((e for e in offered if (e.actor, e.what) == (step.actor, step.what)), None)
        if found is None:
            raise SteppingError(f"step {number}: {step.actor} has no {step.what} any more")
        taken.append(found)
        state = found.after
    return taken


def choices(product: MachineProduct, state: Behaving, said: Mapping[str, bool]) -> Iterator[Choice]:
    """Yields everything that can happen in a state, also what nothing comes of.

    Args:
        said: What conditions of the user say.
    """
    for event in product.events():
        yield _of_the_machine(product, state, ("event", product.component, event), said)
    for message in product.messages():
        for client in product.clients:
            yield _of_the_machine(product, state, ("message", client, message), said)
    clients = product.clients
    for step, core in core_steps(product.services, state.core, product.component, clients):
        why_not = "" if core != state.core else f"it changes nothing in {_standing(state)}"
        after = product.followed(state, core)
        yield Choice("core", step.actor, step.what, after, why_not=why_not)
    yield Choice("time", TIME.actor, TIME.what, product.later(state))


def _of_the_machine(
    product: MachineProduct, state: Behaving, of: tuple[Kind, str, str], said: Mapping[str, bool]
) -> Choice:
    kind, actor, trigger = of
    sender = actor if kind == "message" else ""
    if not product.is_obeyed(state, trigger, sender):
        why_not = f"{actor} is not obeyed in {_standing(state)}"
        return Choice(kind, actor, trigger, state, why_not=why_not)
    transition = product.chosen(state, trigger, sender, said)
    if transition is None:
        why_not = f"no transition takes it in {state.path.rpartition('.')[2]}"
        return Choice(kind, actor, trigger, state, why_not=why_not)
    _, after = product.step(state, transition, trigger, sender)
    return Choice(kind, actor, trigger, after, transition)


def _standing(state: Behaving) -> str:
    who = f"controlled by {state.core.controller}" if state.core.controller else "not controlled"
    return f"{state.core.status}, {who}"
