"""Texts that name elements by paths, and follow when these are renamed.

They are paths through a join of a map, and targets of transitions. A state is looked for in its
machine put together with those that it extends, as `semantics` does it; those of heirs and of
inherited services count as far as the working copy has them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from jausml.authoring.editing.working_copy import ElementCopy, WorkingCopy
from jausml.language.model.refs import Ref
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.language.semantics.jaus.inherited_machines import CORE_MACHINE, Machine, canonical

_STATE = "jaus.State"
_TARGET = "target"
_TRANSITIONS = ("transitions", "defaults")

_DIRECTIONS = {"joins": ("toJaus", TO_JAUS), "reportJoins": ("toRos", TO_ROS)}
"""Where paths may begin with a join: assignments of a map, and vectors of which direction."""

_SOURCE, _PATH = "source", "path"


@dataclass(frozen=True)
class _NamedTarget:
    """A transition that names its target."""

    transition: ElementCopy
    source: str
    text: str
    machine: ElementCopy

    @property
    def target(self) -> str | None:
        """Path of the state that it enters, None where there is none."""
        return _put_together(self.machine).resolve(self.source, self.text)


def targets_through(
    state: ElementCopy, name: str, working_copy: WorkingCopy
) -> Iterator[tuple[ElementCopy, str, str]]:
    """Yields each text that names a state as its target, and the text for another name of it."""
    machine = _machine(state)
    if machine is None or not name or not state.name:
        return
    old, new = _path(state, state.name), _path(state, name)
    for named in _named_targets(machine, working_copy):
        target = named.target
        if target == old or (target or "").startswith(f"{old}."):
            inner = str(target)[len(old) :]
            text = _renamed(named.text, str(target), state.name, name, inner) or f"{new}{inner}"
            if text != named.text:
                yield named.transition, _TARGET, text


def orphaned_transitions(
    gone: Collection[ElementCopy], working_copy: WorkingCopy
) -> Iterator[ElementCopy]:
    """Yields the transitions that enter no state any more when elements go."""
    for machine in {copy: None for copy in map(_machine, gone) if copy is not None}:
        for named in _named_targets(machine, working_copy):
            left = _put_together(named.machine, gone)
            if named.target is not None and left.resolve(named.source, named.text) is None:
                yield named.transition


def _renamed(text: str, target: str, old: str, new: str, inner: str) -> str:
    """Returns a target with another name of a state; empty where only the whole path would do."""
    steps, below = text.split("."), inner.count(".")
    if len(steps) <= below:
        return text
    before = len(steps) - below - len(old.split("."))
    if before < 0 or not f".{target}".endswith(f".{text}"):
        return ""
    return f"{'.'.join([*steps[:before], new])}{inner}"


def _named_targets(machine: ElementCopy, working_copy: WorkingCopy) -> Iterator[_NamedTarget]:
    """Yields the transitions with targets of a machine, and of those that extend it."""
    for copy in (machine, *_heirs(machine, working_copy)):
        for path, state in _states(copy):
            for feature in _TRANSITIONS:
                for transition in state.owned.get(feature, ()):
                    text = next(iter(transition.values.get(_TARGET, ())), None)
                    if text:
                        yield _NamedTarget(transition, path, text, copy)


def _put_together(machine: ElementCopy, gone: Collection[ElementCopy] = ()) -> Machine:
    """Returns the paths of a machine and of those that it extends, without removed states."""
    united_machine = Machine(machine.name)
    for copy in _extended(machine):
        for path, state in _states(copy):
            if state not in gone:
                united_machine.enter(path)
    return united_machine


def _extended(machine: ElementCopy) -> Iterator[ElementCopy]:
    """Yields a machine and those that it extends."""
    service: ElementCopy | Ref | None = machine.owner
    seen: set[ElementCopy] = set()
    while isinstance(service, ElementCopy) and service not in seen:
        seen.add(service)
        yield from _alike(service, machine)
        service = next(iter(service.references.get("inherits", ())), None)


def _heirs(machine: ElementCopy, working_copy: WorkingCopy) -> Iterator[ElementCopy]:
    """Yields the machines that extend one."""
    pending = [machine.owner] if machine.owner is not None else []
    seen = set(pending)
    while pending:
        for heir, feature in working_copy.referrers({pending.pop()}):
            if feature == "inherits" and heir not in seen:
                seen.add(heir)
                pending.append(heir)
                yield from _alike(heir, machine)


def _alike(service: ElementCopy, machine: ElementCopy) -> Iterator[ElementCopy]:
    """Yields the machines of a service that have the name of one."""
    yield from (copy for copy in service.owned.get("machines", ()) if copy.name == machine.name)


def _states(machine: ElementCopy) -> Iterator[tuple[str, ElementCopy]]:
    """Yields the states of a machine with their paths."""
    pending = list(machine.owned.get("states", ()))
    while pending:
        state = pending.pop()
        yield _path(state, state.name), state
        pending += state.owned.get("states", ())


def _machine(copy: ElementCopy) -> ElementCopy | None:
    """Returns the machine of a state, None for other elements."""
    if copy.table.qualified_name != _STATE:
        return None
    around: ElementCopy | None = copy
    while around is not None and around.table.qualified_name == _STATE:
        around = around.owner
    return around


def _path(state: ElementCopy, name: str) -> str:
    """Returns the path of a state if it had a name."""
    names, around = [name], state.owner
    while around is not None and around.table.qualified_name == _STATE:
        names.append(around.name)
        around = around.owner
    path = ".".join(reversed(names))
    return canonical(path) if around is not None and around.name == CORE_MACHINE else path


def paths_through(join: ElementCopy, name: str) -> Iterator[tuple[ElementCopy, str, str]]:
    """Yields elements with paths through a join, the feature, and the paths for another name."""
    if join.owner is None or join.feature not in _DIRECTIONS or not join.name:
        return
    feature, direction = _DIRECTIONS[join.feature]
    for direction_copy in join.owner.owned.get(feature, ()):
        for copy in direction_copy.everything():
            yield from _changed(
                copy, _SOURCE, join.name, name, is_nested=copy is not direction_copy
            )
    for vector in join.owner.owned.get("vectors", ()):
        if vector.values.get("direction", (TO_ROS,)) == (direction,):
            for vector_value in vector.owned.get("given", ()):
                yield from _changed(vector_value, _PATH, join.name, name, is_nested=False)


def _changed(
    copy: ElementCopy, feature: str, old: str, new: str, *, is_nested: bool
) -> Iterator[tuple[ElementCopy, str, str]]:
    text = next(iter(copy.values.get(feature, ())), None)
    if not text:
        return
    # Within a list only paths from outside of it begin with a join.
    lead = "/" if is_nested else ""
    paths = text.split(", ")
    new_paths = [
        f"{lead}{new}{path[len(lead + old) :]}"
        if path == lead + old or path.startswith(f"{lead}{old}.")
        else path
        for path in paths
    ]
    if new_paths != paths:
        yield copy, feature, ", ".join(new_paths)
