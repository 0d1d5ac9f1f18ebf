"""State machines put together: those of one name along the inheritance of services.

A state has a path: the names from the outermost state, joined by dots. A name may be a path
itself, so that enclosing states of which nothing is to be said need not be written: one state
`Receiving.Ready.Controlled.Available.Ready` is the same as five, each inside the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property

from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.core_services import (
    CORE,
    SERVED_BY_RUNTIME,
    core_urn,
    newest_services,
)
from jausml.language.semantics.jaus.inheritance import lineage

CORE_MACHINE = "ReceiveFSM"
"""Machine of the core services, which a machine of this name extends (AS5710, Transport)."""

DEEPEST = 20
"""States around each other; more is no machine that a person wrote."""

MANAGEMENT = f"{CORE}Management"

ENTERED_BY_SERVICES = frozenset(
    [
        "Receiving.Ready.NotControlled.Available.Standby",
        "Receiving.Ready.NotControlled.NotAvailable.Failure",
        "Receiving.Ready.NotControlled.NotAvailable.Shutdown",
        "Receiving.Ready.Controlled.Available.Standby",
    ]
)
"""States of Management that a service may enter by itself; the others take a message of another."""

# AS6009 puts a state around those of Management that its v1.1 does not have.
_GROUPS = ("Receiving.Ready.NotControlled.StateA", "Receiving.Ready.Controlled.StateB")


@dataclass(frozen=True)
class CoreMachine:
    """The states of core services that a machine extends, as the library has them.

    Attributes:
        name: Name of the core service that says the innermost ones, such as Management.
    """

    name: str
    states: tuple[str, ...]

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The states that enclose no other: services that inherit them refine these."""
        enclosing = {path.rpartition(".")[0] for path in self.states}
        return tuple(path for path in self.states if path not in enclosing)

    def leaf(self, path: str) -> str | None:
        """Returns the innermost core state that a state is or lies in, None when there is none."""
        while path and path not in self.leaves:
            path = path.rpartition(".")[0]
        return path or None

    def may_enter(self, source: str, target: str) -> bool:
        """Tells whether a transition of a service may lead from one innermost state to another."""
        if self.name == "Management":
            return target in ENTERED_BY_SERVICES
        # Control is given to who asks for it, and never by a service itself.
        return ".Controlled" in source or ".Controlled" not in target


def core_machine(service: jaus.Service | None) -> CoreMachine:
    """Returns the core states that a machine of a service extends.

    They are those of the core services that it inherits, and of Management where it inherits none.
    """
    known = _core_machines()
    inherited = (known.get(core_urn(ancestor)) for ancestor in lineage(service))
    return next((machine for machine in inherited if machine), known[MANAGEMENT])


def core_events() -> frozenset[str]:
    """Returns the names of the internal events of the core services that others may take.

    Those of Transport carry messages, which a machine takes and sends as messages; each of those of
    Events concerns one event of one client.
    """
    kept = (f"{CORE}Transport", f"{CORE}Events")
    of_core = (service for urn, service in newest_services().items() if urn not in kept)
    return frozenset(str(event.name) for service in of_core for event in service.events)


@cache
def _core_machines() -> Mapping[str, CoreMachine]:
    """Returns the machines of the core services by URN, each with its inherited states."""
    machines_by_urn = {}
    for urn, service in newest_services().items():
        states: dict[str, str] = {}
        # The oldest ancestor first: a state is of the service that was the first to have it.
        for ancestor in reversed(list(lineage(service))):
            for state in (state for machine in ancestor.machines for state in machine.states):
                states.setdefault(str(state.name), str(ancestor.name))
        if states:
            machines_by_urn[urn] = CoreMachine(list(states.values())[-1], tuple(states))
    return machines_by_urn


@dataclass
class StateNode:
    """A state of a machine."""

    path: str
    elements: list[jaus.State] = field(default_factory=list)

    @property
    def is_initial(self) -> bool:
        """Whether an element says that it is initial."""
        return any(element.initial for element in self.elements)

    @property
    def transitions(self) -> list[jaus.Transition]:
        """Its transitions, without those of messages that the runtime takes."""
        return _own(transition for element in self.elements for transition in element.transitions)

    @property
    def defaults(self) -> list[jaus.Transition]:
        """Its default transitions, without those of messages that the runtime takes."""
        return _own(default for element in self.elements for default in element.defaults)


def is_core_trigger(transition: jaus.Transition) -> bool:
    """Tells whether the services of the runtime act on the message of a transition themselves."""
    message = transition.message
    owner = None if message is None else message.eContainer()
    return owner is not None and owner.urn in SERVED_BY_RUNTIME


def _own(transitions: Iterable[jaus.Transition]) -> list[jaus.Transition]:
    return [transition for transition in transitions if not is_core_trigger(transition)]


@dataclass
class Machine:
    """Machines of one name along inheritance."""

    name: str
    core: CoreMachine = field(default_factory=lambda: core_machine(None))
    elements: list[jaus.StateMachine] = field(default_factory=list)
    nodes: dict[str, StateNode] = field(default_factory=dict)
    _inside: dict[str, dict[str, None]] = field(default_factory=dict, init=False, repr=False)
    _initial: dict[str, str | None] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        for path in self.core_states:
            self._enclose(path)

    @property
    def extends_core(self) -> bool:
        """Whether its outer states are those of the core services."""
        return self.name == CORE_MACHINE

    @property
    def core_states(self) -> tuple[str, ...]:
        """The states of the core services that it extends; none of another machine."""
        return self.core.states if self.extends_core else ()

    def core_leaf(self, path: str) -> str | None:
        """Returns the innermost core state that a state is or lies in, None when there is none."""
        return self.core.leaf(path) if self.extends_core else None

    @property
    def service_name(self) -> str:
        """Name of the service that has it, of several the inherited one."""
        service = self.elements[0].eContainer()
        return "" if service is None else service.name

    def add(self, element: jaus.StateMachine) -> None:
        """Adds a machine of an heir."""
        self.elements.append(element)
        # A further machine may say which states are initial.
        self._initial.clear()
        for path, state in states_of(element):
            # What an heir says of a state goes before what it inherits.
            self.enter(path).elements.insert(0, state)

    def enter(self, path: str) -> StateNode:
        """Returns the state of a path, which is added with the enclosing ones."""
        names = path.split(".")
        for length in range(1, len(names) + 1):
            enclosing = ".".join(names[:length])
            if enclosing not in self.nodes:
                self.nodes[enclosing] = StateNode(enclosing)
                self._enclose(enclosing)
        return self.nodes[path]

    def transitions(self) -> Iterator[tuple[str, jaus.Transition]]:
        """Yields all transitions with the paths of their states."""
        for path, node in self.nodes.items():
            for state in node.elements:
                for transition in (*state.transitions, *state.defaults):
                    yield path, transition

    def tried(self, state: str) -> Iterator[tuple[str, jaus.Transition]]:
        """Yields the transitions that may be taken in a state, with the paths of their states.

        They come in the order in which the runtime tries them.
        """
        path = state
        while path:
            node = self.nodes.get(path, StateNode(path))
            groups = (node.transitions, node.defaults)
            for transitions in groups if path == state else reversed(groups):
                yield from ((path, transition) for transition in transitions)
            path = path.rpartition(".")[0]

    def children(self, path: str) -> list[str]:
        """Returns the states directly inside a state, or the outermost ones of an empty path."""
        return list(self._inside.get(path, ()))

    def initial(self, path: str) -> str | None:
        """Returns the state that entering a state enters, None without one."""
        if path not in self._initial:
            self._initial[path] = self._find_initial(path)
        return self._initial[path]

    def _find_initial(self, path: str) -> str | None:
        inside = self.children(path)
        # Which of the core states is entered is up to the core services.
        if inside and inside[0] in self.core_states:
            return inside[0]
        marked = [substate for substate in inside if self.nodes[substate].is_initial]
        if not marked and len(inside) == 1:
            return inside[0]
        return marked[0] if marked else None

    def innermost(self, path: str) -> str:
        """Returns the state that a machine is in after entering a state."""
        inside = self.initial(path)
        while inside is not None:
            path, inside = inside, self.initial(inside)
        return path

    def resolve(self, source: str, target: str) -> str | None:
        """Returns the path of the state that a target means, None when there is none.

        A target is a path from the outermost state, or from a state that the source encloses,
        stands beside, or lies in: the nearest is meant.
        """
        full = canonical(target) if self.extends_core else target
        if self._has(full):
            return full
        outer = source
        while outer:
            if self._has(f"{outer}.{target}"):
                return f"{outer}.{target}"
            outer = outer.rpartition(".")[0]
        return None

    def _enclose(self, path: str) -> None:
        if path:
            self._inside.setdefault(path.rpartition(".")[0], {})[path] = None

    def _has(self, path: str) -> bool:
        return path in self.nodes or path in self.core_states


def machines_of(services: Iterable[jaus.Service]) -> list[Machine]:
    """Returns the machines of services, put together by name along inheritance.

    Two services extend the core each for itself, unless one inherits the other.
    """
    machines: list[Machine] = []
    by_service: dict[jaus.Service | None, dict[str, Machine]] = {}
    for service in services:
        # A copy: what this service adds is not of others that inherit the same.
        inherited = dict(by_service.get(service.inherits, {}))
        for element in service.machines:
            machine = inherited.get(element.name)
            if machine is None:
                machine = inherited[element.name] = Machine(
                    str(element.name), core_machine(service)
                )
                machines.append(machine)
            machine.add(element)
        by_service[service] = inherited
    return machines


def machine_with(element: jaus.StateMachine) -> Machine | None:
    """Returns a machine with those that it extends, but those of the core services.

    Returns:
        None where it stands in no service.
    """
    owner = element.eContainer()
    chain = [
        ancestor
        for ancestor in lineage(owner)
        if ancestor is owner or ancestor.urn not in SERVED_BY_RUNTIME
    ]
    machines = machines_of(reversed(chain))
    return next((machine for machine in machines if element in machine.elements), None)


def states_of(machine: jaus.StateMachine) -> Iterator[tuple[str, jaus.State]]:
    """Yields the states of a machine with their paths, enclosing ones first."""
    aliased = machine.name == CORE_MACHINE
    pending = [("", state) for state in reversed(machine.states)]
    while pending:
        outer, state = pending.pop()
        path = f"{outer}.{state.name}" if outer else str(state.name)
        yield (canonical(path) if aliased else path), state
        pending += [(path, inner) for inner in reversed(state.states)]


def too_deep(machine: jaus.StateMachine) -> Iterator[jaus.State]:
    """Yields the states that lie more than `DEEPEST` states deep, the outermost of each branch."""
    pending = [(0, state) for state in reversed(machine.states)]
    while pending:
        outer, state = pending.pop()
        depth = outer + str(state.name).count(".") + 1
        if depth > DEEPEST:
            yield state
        else:
            pending += [(depth, inner) for inner in reversed(state.states)]


def canonical(path: str) -> str:
    """Returns the path of a state of ReceiveFSM without the groups that only AS6009 has.

    Its StateA and StateB stand for all states of NotControlled and Controlled.
    """
    core = _core_machines()[MANAGEMENT]
    for group in _GROUPS:
        outer = group.rpartition(".")[0]
        if path == group:
            return outer
        if path.startswith(f"{group}."):
            inner = path.removeprefix(f"{group}.")
            for available in ("Available", "NotAvailable"):
                whole = f"{outer}.{available}.{inner}"
                if core.leaf(whole):
                    return whole
    return path


def event_name(text: str | None) -> str:
    """Returns the name of an internal event without the service that AS5684 puts before it.

    Args:
        text: Feature `event` of a transition, e.g. `accessControl.Timedout`.
    """
    return (text or "").rpartition(".")[2].strip()
