"""Ways through state machines, for generated tests: one for each transition that can be taken."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.model.guards import parse_guard
from jausml.model.machines import CORE_LEAVES, CORE_STATES, Machine, core_leaf, event_name

if TYPE_CHECKING:
    from collections.abc import Iterator

LONGEST = 200
"""Ways of one machine; a test of more would say nothing new."""


@dataclass(frozen=True)
class Step:
    """What happens to a machine, and the state that it is in then.

    Attributes:
        trigger: A message, an internal event or, for a machine that extends the core, the core
            state that the core services enter.
        refused: Guards that do not hold before the first that does.
        state: Path of the state.
    """

    trigger: Any
    refused: int
    state: str


Walk = tuple[Step, ...]


def walks(machine: Machine, transitions: dict[str, list[tuple[str, Any]]]) -> list[Walk]:
    """Returns the ways from the start of a machine over each transition from each state.

    Pushes and pops are left out: where a pop leads depends on the whole way.

    Args:
        machine: The machine.
        transitions: Transitions to look at by the path of their state, as (feature, transition).
    """
    found: list[Walk] = []
    reached: dict[str, Walk] = {}
    pending: deque[tuple[str, Walk]] = deque()
    if machine.extends_core:
        for leaf in (path for path in CORE_STATES if path in CORE_LEAVES):
            state = machine.innermost(leaf)
            pending.append((state, (Step(leaf, 0, state),)))
            found.append(pending[-1][1])
    else:
        pending.append((machine.innermost(""), ()))
    while pending:
        state, way = pending.popleft()
        if state in reached:
            continue
        reached[state] = way
        for step in _steps(machine, state, transitions):
            found.append((*way, step))
            pending.append((step.state, (*way, step)))
    return found[:LONGEST]


def _steps(
    machine: Machine, state: str, transitions: dict[str, list[tuple[str, Any]]]
) -> Iterator[Step]:
    listed = list(_listed(state, transitions))
    triggers = {_trigger(transition): None for _, transition in listed}
    for trigger in triggers:
        refused = 0
        for path, transition in listed:
            if trigger is None or _trigger(transition) != trigger:
                continue
            target = _target(machine, state, path, transition)
            if target is not None:
                yield Step(trigger, refused, target)
            if parse_guard(transition.guard) is None:
                break
            refused += 1


def _listed(state: str, transitions: dict[str, list[tuple[str, Any]]]) -> Iterator[tuple[str, Any]]:
    """Yields transitions in the order in which they are tried, with the paths of their states."""
    path = state
    while path:
        order = ("transitions", "defaults") if path == state else ("defaults", "transitions")
        for wanted in order:
            for feature, transition in transitions.get(path, ()):
                if feature == wanted:
                    yield path, transition
        path = path.rpartition(".")[0]


def _trigger(transition: Any) -> Any:
    return transition.message or event_name(transition.event) or None


def _target(machine: Machine, state: str, path: str, transition: Any) -> str | None:
    """Returns the state after a transition, None when it depends on more than the state."""
    kind = transition.kind.name
    if kind in ("push", "pop"):
        return None
    if kind == "internal" or not transition.target:
        return state
    target = machine.resolve(path, transition.target)
    if target is None:
        return None
    entered = machine.innermost(target)
    return entered if not machine.extends_core or core_leaf(entered) else None
