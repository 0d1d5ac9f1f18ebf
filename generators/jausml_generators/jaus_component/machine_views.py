"""View of a state machine for templates: methods, events, diagram, and walks for its test."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterator
from dataclasses import dataclass

from jausml.generation.literals import clean, docstring, python_string
from jausml.language.attributes.guards import AllOf, AnyOf, Condition, Guard, Negation, parse_guard
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.inherited_machines import Machine, event_name
from jausml_generators.jaus_component.handlers import Method
from jausml_generators.python.statements import call, tuple_of

_BODY = 8


@dataclass(frozen=True)
class MachineMethod(Method):
    """A guard or an action; the base only counts that it is not implemented."""

    @property
    def default(self) -> tuple[str, ...]:
        """Statements of the base."""
        detail = python_string(self.name)
        if self.parameters:
            detail = f'f"{self.name}: {{message!r}} of {{sender}}"'
        count = call("self.counters.count", '"component.not_implemented"', detail)
        result = {"None": (), "bool": ("return False",)}.get(self.result, ("return None",))
        return (count, *result)


@dataclass(frozen=True)
class EventView:
    """An internal event of the component's services."""

    method: str
    name: str
    documentation: str

    @property
    def docstring(self) -> str:
        """Docstring of the method."""
        further = ("Callable from any thread.",)
        return docstring(self.documentation, _BODY, further)

    @property
    def statement(self) -> str:
        """Body of the method."""
        return call("self.raise_event", python_string(self.name))


@dataclass(frozen=True)
class MachineView:
    """A state machine.

    Attributes:
        walks: Steps over each transition, as expressions, for the generated test.
    """

    machine: Machine
    attribute: str
    table: str
    displays: tuple[str, ...]
    walks: tuple[str, ...]

    @property
    def name(self) -> str:
        """Its name in the model, clean."""
        return clean(self.machine.name)

    @property
    def service(self) -> str:
        """Name of the service that has it, the inherited one of several, clean."""
        return clean(self.machine.service_name)

    @property
    def registration(self) -> str:
        """Statement of the constructor."""
        arguments = [python_string(self.name), f"self.{self.table}()"]
        if self.machine.extends_core:
            arguments.append(f"extends={python_string(self.machine.core.name)}")
        owner = self.machine.elements[-1].eContainer()
        if owner is not None and owner.urn:
            arguments.append(f"service={python_string(str(owner.urn))}")
        return f"self.{self.attribute} = {call('self.add_machine', *arguments)}"

    @property
    def docstring(self) -> str:
        """Docstring of the method that returns the states."""
        text = f"Returns the states of {self.name} of {self.service}, and what happens in them."
        return docstring(text, _BODY)

    @property
    def diagram(self) -> str:
        """The machine as a state diagram."""
        return diagram(self.machine)

    @property
    def walks_constant(self) -> str:
        """Name of the constant of the generated test."""
        return f"WAYS_OF_{self.attribute.upper()}"

    @property
    def walks_text(self) -> str:
        """Assignment of the walks in the generated test."""
        return f"{self.walks_constant}: _Ways = {tuple_of(*self.walks)}"

    @property
    def test_signature(self) -> str:
        """First lines of the generated test of the walks."""
        name = f"test_{self.attribute}_goes_as_modelled"
        return (
            f'@pytest.mark.parametrize("way", {self.walks_constant})\n'
            f"def {name}(way: _Way) -> None:"
        )

    @property
    def states(self) -> str:
        """Statement that returns the states."""
        return f"return {tuple_of(*self.displays)}"


_INDENT = "    "


def diagram(machine: Machine) -> str:
    """Returns the lines of a diagram: the modelled states, each inside the enclosing one.

    A transition that only acts leads from its state to itself and says so.
    """
    keys = {path: f"s{number}" for number, path in enumerate(_shown(machine), 1)}
    inside: dict[str, list[str]] = {}
    for path in keys:
        inside.setdefault(path.rpartition(".")[0], []).append(path)
    lines = ["stateDiagram-v2", *_states(machine, keys, inside, "", 1)]
    arrows = (_arrow(machine, keys, *placed) for placed in machine.transitions())
    lines += (_INDENT + arrow for arrow in arrows)
    return "\n".join(lines)


def guard_text(guard: Guard) -> str:
    """Returns a guard as text again, without what stands before names and in parentheses."""
    if isinstance(guard, Condition):
        return guard.name
    if isinstance(guard, Negation):
        inner = guard_text(guard.operand)
        return f"!{inner}" if isinstance(guard.operand, Condition) else f"!({inner})"
    sign = " && " if isinstance(guard, AllOf) else " || "
    return sign.join(
        f"({guard_text(operand)})" if isinstance(operand, AnyOf) else guard_text(operand)
        for operand in guard.operands
    )


def _shown(machine: Machine) -> list[str]:
    """Returns the modelled states and the targets of their transitions, enclosing ones too."""
    paths = dict.fromkeys(machine.nodes)
    for path, transition in machine.transitions():
        target = machine.resolve(path, transition.target) if transition.target else None
        paths.update(dict.fromkeys(_around(target or "")))
    paths.pop("", None)
    return list(paths)


def _states(
    machine: Machine, keys: dict[str, str], inside: dict[str, list[str]], outer: str, depth: int
) -> Iterator[str]:
    margin = _INDENT * depth
    initial = machine.initial(outer)
    # Which core state is entered first is not for this machine to say.
    if initial in keys and initial not in machine.core_states:
        yield f"{margin}[*] --> {keys[initial]}"
    for path in inside[outer]:
        name = path.rpartition(".")[2]
        if path in inside:
            yield f'{margin}state "{name}" as {keys[path]} {{'
            yield from _states(machine, keys, inside, path, depth + 1)
            yield f"{margin}}}"
        else:
            yield f'{margin}state "{name}" as {keys[path]}'


def _arrow(machine: Machine, keys: dict[str, str], path: str, transition: jaus.Transition) -> str:
    message = transition.message
    label = message.name if message is not None else event_name(transition.event) or "anything else"
    guard = parse_guard(transition.guard)
    if guard is not None:
        label += f" [{guard_text(guard)}]"
    if transition.actions:
        label += " / " + ", ".join(action.name.rpartition(".")[2] for action in transition.actions)
    kind = transition.kind.name
    is_staying = kind == "internal" or (kind == "simple" and not transition.target)
    label += " (stays)" if is_staying else {"push": " (push)", "pop": " (pop)"}.get(kind, "")
    target = machine.resolve(path, transition.target) if transition.target else path
    return f"{keys[path]} --> {keys[target or path]} : {label}"


EVENT = "event "
"""The prefix of an event that triggers: a message may have the same name."""
LONGEST = 200
"""Ways of one machine; a test of more would say nothing new."""


@dataclass(frozen=True)
class Step:
    """A step of a machine, and the state after it.

    Attributes:
        actions: What it does on the way; what it does as the core services change is left out.
    """

    trigger: jaus.MessageDef | str
    refused: int
    state: str
    actions: tuple[jaus.Action, ...] = ()


Walk = tuple[Step, ...]


@dataclass(frozen=True)
class _Place:
    """Where a way has led: a state, and the states that pushes have remembered, the last last."""

    state: str
    remembered: tuple[str, ...] = ()


def walks(machine: Machine) -> list[Walk]:
    """Returns the walks from the start of a machine over each transition from each state.

    The way to a state tells what its pushes have remembered, and so where a pop leads.
    """
    routes: list[Walk] = []
    reached: set[str] = set()
    pending: deque[tuple[Walk, _Place]] = deque()
    if machine.extends_core:
        for leaf in machine.core.leaves:
            state = machine.innermost(leaf)
            pending.append(((Step(leaf, 0, state),), _Place(state)))
            routes.append(pending[-1][0])
    else:
        pending.append(((), _Place(machine.innermost(""))))
    while pending and len(routes) < LONGEST:
        way, place = pending.popleft()
        if place.state in reached:
            continue
        reached.add(place.state)
        for step, after in _steps(machine, place):
            routes.append((*way, step))
            pending.append((routes[-1], after))
    return routes[:LONGEST]


def _steps(machine: Machine, place: _Place) -> Iterator[tuple[Step, _Place]]:
    by_trigger = defaultdict(list)
    for path, transition in machine.tried(place.state):
        by_trigger[_trigger(transition)].append((path, transition))
    for trigger, tried in by_trigger.items():
        if trigger is None:
            continue
        for refused, (path, transition) in enumerate(tried):
            after = _after(machine, place, path, transition)
            if after is not None:
                actions = tuple(_actions(machine, place.state, transition, after.state))
                yield Step(trigger, refused, after.state, actions), after
            if parse_guard(transition.guard) is None:
                break


def _trigger(transition: jaus.Transition) -> jaus.MessageDef | str | None:
    event = event_name(transition.event)
    return transition.message or (event and f"{EVENT}{event}") or None


def _actions(
    machine: Machine, state: str, transition: jaus.Transition, after: str
) -> Iterator[jaus.Action]:
    """Yields the actions of a transition from a state to another: exits, its own, entries."""
    kind = transition.kind.name
    if kind == "internal" or (kind == "simple" and not transition.target):
        yield from transition.actions
        return
    left, entered = (list(_around(state_path)) for state_path in (state, after))
    # Never one of the two: a transition to the present state leaves and enters it.
    pairs = zip(left[:-1], entered[:-1], strict=False)
    common = sum(one == other for one, other in pairs)
    for path in reversed(left[common:]):
        yield from _of_states(machine, path, "exit")
    yield from transition.actions
    for path in entered[common:]:
        yield from _of_states(machine, path, "entry")


def _around(state: str) -> Iterator[str]:
    """Yields a state and those that enclose it, the outermost first."""
    names = state.split(".")
    for end in range(1, len(names) + 1):
        yield ".".join(names[:end])


def _of_states(machine: Machine, path: str, feature: str) -> Iterator[jaus.Action]:
    node = machine.nodes.get(path)
    for state in node.elements if node is not None else ():
        yield from getattr(state, feature)


def _after(
    machine: Machine, place: _Place, path: str, transition: jaus.Transition
) -> _Place | None:
    """Returns where a transition leads, None when the core services have a say in it."""
    kind = transition.kind.name
    if kind == "pop":
        # The runtime ignores a pop without a push.
        *rest, last = place.remembered or (None,)
        return None if last is None else _Place(last, tuple(rest))
    if kind == "internal" or not transition.target:
        return place
    target = machine.resolve(path, transition.target)
    if target is None:
        return None
    entered = machine.innermost(target)
    core = machine.core_leaf(entered)
    if machine.extends_core and not core:
        return None
    if core != machine.core_leaf(place.state):
        return _Place(entered)
    remembered = (*place.remembered, place.state) if kind == "push" else place.remembered
    return _Place(entered, remembered)
