"""What services inherit: services of the library, known names, and the states of machines."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.language.metamodel.classes import jaus
from jausml.language.model.values import show, suggest
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inherited_machines import (
    Machine,
    core_events,
    machines_of,
)
from jausml.language.semantics.jaus.services import lineage

if TYPE_CHECKING:
    from collections.abc import Container, Iterable

    from jausml.language.importers.jsidl.building import Findings
    from jausml.language.importers.jsidl.services import ImportedService
    from jausml.language.model.model import Model


def services_by_urn(model: Model) -> dict[str, dict[str, jaus.Service]]:
    """Returns the services of a model by URN and version."""
    found: dict[str, dict[str, jaus.Service]] = {}
    for service in model.instances(jaus.Service):
        found.setdefault(service.urn, {})[service.version] = service
    return found


def bases_first(services: Iterable[jaus.Service]) -> list[jaus.Service]:
    """Returns services in an order in which each follows those that it inherits."""
    return sorted(services, key=lambda service: len(lineage(service)))


class BehaviourNames:
    """The names that the protocol behaviour of a service may use.

    Attributes:
        served: Inherited messages that the runtime takes, with the names of their services.
    """

    def __init__(self, service: jaus.Service, declared: Container[str]) -> None:
        self.inputs: dict[str, jaus.MessageDef] = {}
        self.outputs: dict[str, jaus.MessageDef] = {}
        self.events: set[str] = set(core_events())
        self.served: dict[jaus.MessageDef, str] = {}
        self._declared = declared
        is_core = service.urn in SERVED_BY_RUNTIME
        for each in lineage(service):
            if each.urn in SERVED_BY_RUNTIME and not is_core:
                self.served |= dict.fromkeys(each.inputs, each.name)
            for message in each.inputs:
                self.inputs.setdefault(message.name, message)
            for message in each.outputs:
                self.outputs.setdefault(message.name, message)
            self.events |= {event.name for event in each.events}

    def is_declared(self, name: str) -> bool:
        """Tells whether the files declare a message or event, if only with errors."""
        return name in self._declared


def finish_machines(services: Iterable[ImportedService], model: Model, findings: Findings) -> None:
    """Takes out transitions to states that do not exist, and marks missing initial states."""
    for machine in machines_of(bases_first(each.service for each in services)):
        _check_targets(machine, model, findings)
        _check_initial(machine, model, findings)


def _check_targets(machine: Machine, model: Model, findings: Findings) -> None:
    for path, node in machine.nodes.items():
        for state in node.elements:
            for transitions in (state.transitions, state.defaults):
                written = cast("list[jaus.Transition]", transitions)
                for transition in tuple(written):
                    target = transition.target
                    if target and machine.resolve(path, target) is None:
                        message = f"machine '{machine.name}' has no state {show(target)}"
                        hint = suggest(target, [*machine.nodes, *machine.children("")])
                        findings.report("JML622", model.location(transition), message, hint)
                        written.remove(transition)


def _check_initial(machine: Machine, model: Model, findings: Findings) -> None:
    for path in ["", *machine.nodes]:
        inside = machine.children(path)
        if any(each in machine.core_states for each in inside):
            continue  # the core decides
        where = f"state '{path}'" if path else f"machine '{machine.name}'"
        marked = [each for each in inside if machine.nodes[each].is_initial]
        if len(inside) > 1 and not marked:
            element = _first_element(machine, inside)
            if element is not None:
                element.initial = True
                message = f"{where} does not say which state is entered first"
                hint = f"'{element.name}' was taken"
                findings.report("JML625", model.location(element), message, hint)
        for other in marked[1:]:
            # The states of heirs stand behind those of the service that they inherit.
            for element in machine.nodes[other].elements:
                if element.initial:
                    element.initial = False
                    message = f"{where} enters '{marked[0]}' first, as in the inherited service"
                    hint = f"'{element.name}' is not initial"
                    findings.report("JML624", model.location(element), message, hint)


def _first_element(machine: Machine, paths: Iterable[str]) -> jaus.State | None:
    for path in paths:
        node = machine.nodes.get(path)
        if node is not None and node.elements:
            return node.elements[0]
    return None
