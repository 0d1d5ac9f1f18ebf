"""State machines as rules see them: put together along inheritance, with their transitions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import (
    Machine,
    event_name,
    machines_of,
    states_of,
    too_deep,
)
from jausml.language.semantics.subject import Subject


@dataclass(frozen=True)
class Behaviour:
    """A machine of a service."""

    service: jaus.Service
    element: jaus.StateMachine
    machine: Machine

    def states(self) -> list[tuple[str, jaus.State]]:
        """Returns the states of the service's own machine with their paths."""
        return list(states_of(self.element))

    def transitions(self) -> Iterator[tuple[str, jaus.Transition]]:
        """Yields the transitions of the service's own machine with the paths of their states."""
        for path, state in self.states():
            for transition in (*state.transitions, *state.defaults):
                yield path, transition

    def actions(self) -> Iterator[jaus.Action]:
        """Yields the actions of the service's own machine."""
        for _, state in self.states():
            yield from (*state.entry, *state.exit)
            for transition in (*state.transitions, *state.defaults):
                yield from transition.actions

    def target(self, path: str, transition: jaus.Transition) -> str | None:
        """Returns the state that a transition enters in the end, None without a known target."""
        if not transition.target:
            return None
        state = self.machine.resolve(path, transition.target)
        return None if state is None else self.machine.innermost(state)

    def entered(self) -> set[str]:
        """Returns the innermost states that the machine can be in."""
        machine = self.machine
        starts = machine.core.leaves if machine.extends_core else ("",)
        pending = [state for path in starts for state in self._innermost(path)]
        states: set[str] = set()
        while pending:
            state = pending.pop()
            if state in states:
                continue
            states.add(state)
            outer = state
            while outer:
                node = machine.nodes.get(outer)
                for element in node.elements if node is not None else ():
                    for transition in (*element.transitions, *element.defaults):
                        target = self.target(outer, transition)
                        if target is not None:
                            pending += self._innermost(target)
                outer = outer.rpartition(".")[0]
        return states

    def _innermost(self, path: str) -> list[str]:
        """Returns the innermost states after an entry: several where none is initial."""
        states = []
        pending = [path]
        while pending:
            inside = self.machine.children(outer := pending.pop())
            if not inside:
                states.append(outer)
            elif inside[0] in self.machine.core_states:
                pending.append(inside[0])
            else:
                nodes = self.machine.nodes
                pending += [substate for substate in inside if nodes[substate].is_initial] or inside
        return states


def behaviours_of(subject: Subject, service: jaus.Service) -> tuple[Behaviour, ...]:
    """Returns the machines of a service; none of the core services, nor of what was not read.

    Machines whose states lie too deep are left out too: JML506 names them.
    """
    return subject.once(_behaviours, service)


def _behaviours(subject: Subject, service: jaus.Service) -> tuple[Behaviour, ...]:
    if service.urn in SERVED_BY_RUNTIME or not service.machines:
        return ()
    chain = [
        ancestor for ancestor in reversed(lineage(service)) if ancestor.urn not in SERVED_BY_RUNTIME
    ]
    if not all(subject.is_intact(ancestor) for ancestor in chain):
        return ()
    if any(True for ancestor in chain for machine in ancestor.machines for _ in too_deep(machine)):
        return ()
    machines = machines_of(chain)
    wholes = (
        (element, next((machine for machine in machines if element in machine.elements), None))
        for element in service.machines
    )
    return tuple(
        Behaviour(service, machine, whole) for machine, whole in wholes if whole is not None
    )


def trigger(transition: jaus.Transition) -> tuple[str, str]:
    """Returns the trigger of a transition, to be compared: kind and name or code."""
    message = transition.message
    if message is not None:
        return "message", str(message.code).lower()
    return "event", event_name(transition.event)


def described(transition: jaus.Transition) -> str:
    """Returns how messages name what triggers a transition."""
    if transition.message is not None:
        return str(transition.message.name)
    return event_name(transition.event) or "anything else"
