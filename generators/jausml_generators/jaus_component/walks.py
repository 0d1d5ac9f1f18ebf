"""Ways through state machines, for generated tests: one for each transition that can be taken."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.attributes.guards import parse_guard
from jausml.language.semantics.inherited_machines import (
    CORE_LEAVES,
    CORE_STATES,
    Machine,
    core_leaf,
    event_name,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from typing import TypeAlias

    from jausml.language.metamodel.classes import jaus

    Listed: TypeAlias = Mapping[str, tuple[Sequence[jaus.Transition], Sequence[jaus.Transition]]]

LONGEST = 200
"""Ways of one machine; a test of more would say nothing new."""


@dataclass(frozen=True)
class Step:
    """What happens to a machine, and the state that it is in then."""

    trigger: jaus.MessageDef | str
    refused: int
    state: str


Walk = tuple[Step, ...]


@dataclass(frozen=True)
class _Place:
    """Where a way has led: a state, and the states that pushes have remembered, the last last."""

    state: str
    remembered: tuple[str, ...] = ()


def walks(machine: Machine, transitions: Listed) -> list[Walk]:
    """Returns the ways from the start of a machine over each transition from each state.

    The way to a state tells what its pushes have remembered, and so where a pop leads.
    """
    found: list[Walk] = []
    reached: set[str] = set()
    pending: deque[tuple[Walk, _Place]] = deque()
    if machine.extends_core:
        for leaf in (path for path in CORE_STATES if path in CORE_LEAVES):
            state = machine.innermost(leaf)
            pending.append(((Step(leaf, 0, state),), _Place(state)))
            found.append(pending[-1][0])
    else:
        pending.append(((), _Place(machine.innermost(""))))
    while pending and len(found) < LONGEST:
        way, place = pending.popleft()
        if place.state in reached:
            continue
        reached.add(place.state)
        for step, after in _steps(machine, place, transitions):
            found.append((*way, step))
            pending.append((found[-1], after))
    return found[:LONGEST]


def _steps(machine: Machine, place: _Place, transitions: Listed) -> Iterator[tuple[Step, _Place]]:
    listed = list(_listed(place.state, transitions))
    triggers = {_trigger(transition): None for _, transition in listed}
    for trigger in triggers:
        refused = 0
        for path, transition in listed:
            if trigger is None or _trigger(transition) != trigger:
                continue
            after = _after(machine, place, path, transition)
            if after is not None:
                yield Step(trigger, refused, after.state), after
            if parse_guard(transition.guard) is None:
                break
            refused += 1


def _listed(state: str, transitions: Listed) -> Iterator[tuple[str, jaus.Transition]]:
    """Yields transitions in the order in which they are tried, with the paths of their states."""
    path = state
    while path:
        own, defaults = transitions.get(path, ((), ()))
        for transition in (*own, *defaults) if path == state else (*defaults, *own):
            yield path, transition
        path = path.rpartition(".")[0]


def _trigger(transition: jaus.Transition) -> jaus.MessageDef | str | None:
    return transition.message or event_name(transition.event) or None


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
    if machine.extends_core and not core_leaf(entered):
        return None
    if core_leaf(entered) != core_leaf(place.state):
        return _Place(entered)
    remembered = (*place.remembered, place.state) if kind == "push" else place.remembered
    return _Place(entered, remembered)
